#include "drivers/lidar/ouster/metadata.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "drivers/lidar/model.h"
#include "test_data.h"

namespace ca2 {
namespace {

using test::packet_file;

TEST(OusterMetadata, EveryRealFileOfEveryFirmwareIsRead) {
  CA2_NEEDS_PACKETS(packet_file("ouster/metadata"));
  int files = 0;
  for (const char* folder : {"ouster", "ouster/metadata"}) {
    for (const auto& entry : std::filesystem::directory_iterator(packet_file(folder))) {
      const std::string name = entry.path().filename().string();
      if (entry.path().extension() != ".json" || name.ends_with("_digest.json")) continue;
      const auto metadata = read_ouster_metadata(entry.path());
      ASSERT_TRUE(metadata) << metadata.error().text();
      ++files;
      EXPECT_EQ(metadata->altitude.size(), static_cast<std::size_t>(metadata->pixels_per_column));
      EXPECT_EQ(metadata->pixel_shift.size(), metadata->altitude.size());
      EXPECT_GT(metadata->valid_columns(), 0) << name;
      EXPECT_EQ(metadata->serial > 0, name.find("reduced") == std::string::npos) << name;
      // What is read can be written and is then read as the same.
      const auto again = parse_ouster_metadata(write_ouster_metadata(*metadata), "written");
      ASSERT_TRUE(again) << again.error().text();
      EXPECT_EQ(write_ouster_metadata(*again), write_ouster_metadata(*metadata)) << name;
      EXPECT_EQ(again->altitude, metadata->altitude);
      EXPECT_EQ(again->lidar_to_sensor, metadata->lidar_to_sensor);
    }
  }
  EXPECT_EQ(files, 34);
}

TEST(OusterMetadata, MalformedFilesGetTheVendorsVerdict) {
  CA2_NEEDS_PACKETS(packet_file("ouster/metadata/malformed"));
  const auto read = [](const std::string& name) {
    return read_ouster_metadata(packet_file("ouster/metadata/malformed/" + name + ".json"));
  };
  for (const char* name : {"incomplete_no_sensor_info_nonlegacy", "incomplete_no_calref_nonlegacy",
                           "garbled_legacy_and_nonlegacy"}) {
    const auto refused = read(name);
    ASSERT_FALSE(refused) << name;
    EXPECT_EQ(refused.error().code, ErrorCode::data);
    EXPECT_NE(refused.error().text().find("incomplete"), std::string::npos) << refused.error().text();
  }
  const auto warned = read("incomplete_data_format_nonlegacy");
  ASSERT_TRUE(warned) << warned.error().text();
  EXPECT_FALSE(warned->warnings.empty());
}

/// The vendor reads it, with warnings: every point would be in one plane.
TEST(OusterMetadata, AnglesThatAreAllZeroAreRefused) {
  CA2_NEEDS_PACKETS(packet_file("ouster/metadata/malformed"));
  const auto zeros =
      read_ouster_metadata(packet_file("ouster/metadata/malformed/complete_but_all_zeros_legacy.json"));
  ASSERT_FALSE(zeros);
  EXPECT_EQ(zeros.error().code, ErrorCode::data);
  EXPECT_NE(zeros.error().text().find("beam_altitude_angles: all 128 beams have the same, 0 degrees"),
            std::string::npos)
      << zeros.error().text();
}

/// From 20 degrees downwards.
std::vector<double> altitudes(std::size_t count) {
  std::vector<double> angles;
  for (std::size_t i = 0; i < count; ++i) angles.push_back(20 - 0.5 * static_cast<double>(i));
  return angles;
}

/// The smallest metadata there is, changed by `change`.
Result<OusterMetadata> parse(const std::function<void(nlohmann::json&)>& change) {
  nlohmann::json json{{"lidar_mode", "1024x20"},
                      {"beam_altitude_angles", altitudes(64)},
                      {"beam_azimuth_angles", std::vector<double>(64, 3.0)}};
  change(json);
  return parse_ouster_metadata(json.dump(), "sensor.json");
}

TEST(OusterMetadata, DefaultsAreTheVendors) {
  const auto metadata = parse([](auto&) {});
  ASSERT_TRUE(metadata) << metadata.error().text();
  EXPECT_EQ(metadata->profile, "LEGACY");
  EXPECT_EQ(metadata->columns_per_frame, 1024);
  EXPECT_EQ(metadata->rate, 20);
  EXPECT_EQ(metadata->columns_per_packet, 16);
  EXPECT_EQ(metadata->window_last, 1023);
  EXPECT_DOUBLE_EQ(metadata->beam_origin_x, 12.163);
  EXPECT_EQ(metadata->lidar_to_sensor(0, 0), -1);
  EXPECT_EQ(metadata->lidar_to_sensor(2, 3), 36.18);
  for (const auto& [line, offset] :
       {std::pair{"OS-0-128", 27.67}, std::pair{"OS-1-64-AH", 15.806}, std::pair{"OS-2-32-U0", 13.762}}) {
    EXPECT_DOUBLE_EQ(parse([&](auto& json) { json["prod_line"] = line; })->beam_origin_x, offset);
  }
}

TEST(OusterMetadata, WindowsMayWrap) {
  const auto metadata = parse([](auto& json) {
    json["data_format"] = {
        {"columns_per_frame", 512}, {"column_window", {370, 85}}, {"pixels_per_column", 64}};
  });
  ASSERT_TRUE(metadata) << metadata.error().text();
  EXPECT_EQ(metadata->valid_columns(), 228);
  int inside = 0;
  for (int id = 0; id < 512; ++id) inside += metadata->in_window(id);
  EXPECT_EQ(inside, 228);
  EXPECT_FALSE(metadata->warnings.empty());  // the mode says 1024 columns
}

TEST(OusterMetadata, EveryProblemIsNamed) {
  const auto refused = parse([](auto& json) {
    json["lidar_mode"] = "fast";
    json["beam_azimuth_angles"].push_back(1);
    json["udp_profile_lidar"] = "RNG99";
    json["data_format"] = {{"columns_per_packet", "many"},
                           {"column_window", {0, 5000}},
                           {"columns_per_frame", 1024},
                           {"udp_profile_lidar", "RNG99"}};
  });
  ASSERT_FALSE(refused);
  const std::string text = refused.error().text();
  for (const char* word :
       {"lidar_mode", "beam_azimuth_angles", "columns_per_packet", "column_window", "RNG99"}) {
    EXPECT_NE(text.find(word), std::string::npos) << word << "\n" << text;
  }
  EXPECT_NE(parse_ouster_metadata("{\n  \"a\": ,\n}", "m.json").error().text().find("m.json:2:"),
            std::string::npos);
  EXPECT_FALSE(parse_ouster_metadata("", "m.json"));
  EXPECT_FALSE(parse_ouster_metadata("[1, 2]", "m.json"));
  EXPECT_FALSE(parse([](auto& json) { json["beam_altitude_angles"] = {{1, 2}, {3, 4}}; }));
  EXPECT_FALSE(parse([](auto& json) { json.erase("lidar_mode"); }));
  EXPECT_FALSE(parse([](auto& json) { json["lidar_to_sensor_transform"] = {1, 2, 3}; }));
}

TEST(OusterMetadata, GeometryThatIsNoSensorsIsRefused) {
  const auto refused = [](const char* key, const nlohmann::json& value, const char* what) {
    const auto metadata = parse([&](auto& json) { json[key] = value; });
    ASSERT_FALSE(metadata) << key;
    EXPECT_NE(metadata.error().text().find(std::string(key) + ": " + what), std::string::npos)
        << metadata.error().text();
  };
  refused("beam_altitude_angles", std::vector<double>(64, 1.5), "all 64 beams have the same");
  refused("beam_azimuth_angles", altitudes(63), "has 63 angles for 64 pixels");
  std::vector<double> angles = altitudes(64);
  angles[5] = 1e30;
  refused("beam_altitude_angles", angles, "must be from -90 to 90");
  refused("beam_azimuth_angles", angles, "must be from -360 to 360");
  angles[5] = NAN;  // JSON has none: null
  refused("beam_altitude_angles", angles, "must be a list of finite numbers");
  refused("lidar_to_sensor_transform", std::vector<double>(16, 0), "is no rotation");
  refused("imu_to_sensor_transform", {1, 0, 0, 1e30, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, "is no rotation");
  refused("beam_to_lidar_transform", {1, 0, 0, -1e30, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, "the beams begin");
  EXPECT_TRUE(parse([](auto& json) {
    json["beam_altitude_angles"] = {1.5};
    json["beam_azimuth_angles"] = {3.0};
  })) << "one beam has one angle";
}

}  // namespace
}  // namespace ca2
