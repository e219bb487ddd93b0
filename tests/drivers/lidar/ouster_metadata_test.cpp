#include "drivers/lidar/ouster/metadata.h"

#include <gtest/gtest.h>

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
  for (const char* name : {"complete_but_all_zeros_legacy", "incomplete_data_format_nonlegacy"}) {
    const auto warned = read(name);
    ASSERT_TRUE(warned) << warned.error().text();
    EXPECT_FALSE(warned->warnings.empty()) << name;
  }
}

/// The smallest metadata there is, changed by `change`.
Result<OusterMetadata> parse(const std::function<void(nlohmann::json&)>& change) {
  nlohmann::json json{{"lidar_mode", "1024x20"},
                      {"beam_altitude_angles", std::vector<double>(64, 1.5)},
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

}  // namespace
}  // namespace ca2
