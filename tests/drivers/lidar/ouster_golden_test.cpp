// Real recordings against what the vendor's own library made of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "drivers/lidar/ouster/decoder.h"
#include "md5.h"
#include "test_data.h"

namespace ca2 {
namespace {

using test::packet_file;

struct Decoded {
  std::vector<OusterFrame> frames;
  std::vector<LidarScan> scans;
  LidarCounters counters;
};

Decoded decode_capture(const std::string& pcap, const std::string& metadata_file) {
  Decoded out;
  const auto metadata = read_ouster_metadata(packet_file("ouster/" + metadata_file));
  EXPECT_TRUE(metadata) << metadata.error().text();
  if (!metadata) return out;
  OusterOptions options;
  options.extra_fields = true;
  options.second_returns = false;
  options.frame_sink = [&](const OusterFrame& frame) { out.frames.push_back(frame); };
  OusterDecoder decoder(*metadata, options);
  const LidarSink sink = [&](LidarScan&& scan) { out.scans.push_back(std::move(scan)); };
  for (const test::Packet& packet : test::read_packets(packet_file("ouster/" + pcap))) {
    decoder.push(packet.view(), out.counters, sink);
  }
  decoder.flush(out.counters, sink);
  return out;
}

/// The vendor's arrays are row-major; ours go by column.
template <class T>
std::string digest(const OusterFrame& frame, const std::vector<T>& field) {
  if (field.empty()) return "the profile has no such field";
  std::vector<T> rows(field.size());
  for (int row = 0; row < frame.rows; ++row) {
    for (int column = 0; column < frame.columns; ++column) {
      rows[static_cast<std::size_t>(row) * frame.columns + column] =
          field[static_cast<std::size_t>(column) * frame.rows + row];
    }
  }
  return test::md5(rows.data(), rows.size() * sizeof(T));
}

/// The same of each packet, one packet after the other.
template <class T>
std::string packets_digest(const OusterFrame& frame, int columns_per_packet, const std::vector<T>& field) {
  std::vector<T> packets;
  for (int first = 0; first < frame.columns && !field.empty(); first += columns_per_packet) {
    for (int row = 0; row < frame.rows; ++row) {
      for (int column = first; column < first + columns_per_packet; ++column) {
        packets.push_back(field[static_cast<std::size_t>(column) * frame.rows + row]);
      }
    }
  }
  return test::md5(packets.data(), packets.size() * sizeof(T));
}

template <class T>
std::string digest(const std::vector<T>& columns) {
  return test::md5(columns.data(), columns.size() * sizeof(T));
}

class VendorDigest : public testing::TestWithParam<const char*> {};

TEST_P(VendorDigest, EveryFieldOfTheScanIsTheVendors) {
  const std::string name = GetParam();
  CA2_NEEDS_PACKETS(packet_file("ouster/" + name + "_digest.json"));
  const Decoded decoded = decode_capture(name + ".pcap", name + ".json");
  ASSERT_EQ(decoded.frames.size(), 1u);
  const OusterFrame& frame = decoded.frames[0];
  std::map<std::string, std::string> ours{
      {"FRAME_ID", std::to_string(frame.frame_id)},
      {"TIMESTAMP", digest(frame.timestamp)},
      {"STATUS", digest(std::vector<std::uint64_t>(frame.status.begin(), frame.status.end()))},
      {"MEASUREMENT_ID", digest(frame.measurement_id)},
      {"RANGE", digest(frame, frame.range[0])},
      {"RANGE2", digest(frame, frame.range[1])},
      {"SIGNAL", digest(frame, frame.signal[0])},
      {"SIGNAL2", digest(frame, frame.signal[1])},
      {"REFLECTIVITY", digest(frame, frame.reflectivity[0])},
      {"REFLECTIVITY2", digest(frame, frame.reflectivity[1])},
      {"NEAR_IR", digest(frame, frame.near_ir)}};
  const auto all = nlohmann::json::parse(test::slurp(packet_file("ouster/" + name + "_digest.json")));
  const auto published = all["scans"][0];
  int compared = 0;
  for (const auto& [field, value] : published.items()) {
    if (field == "ENCODER_COUNT") continue;  // not used for angles, not decoded
    ASSERT_TRUE(ours.contains(field)) << field;
    EXPECT_EQ(ours[field], value.get<std::string>()) << field;
    ++compared;
  }
  EXPECT_GE(compared, 7);

  const std::map<std::string, std::string> by_packet{
      {"TIMESTAMP", digest(frame.timestamp)},
      {"MEASUREMENT_ID", digest(frame.measurement_id)},
      {"RANGE", packets_digest(frame, 16, frame.range[0])},
      {"RANGE2", packets_digest(frame, 16, frame.range[1])},
      {"SIGNAL", packets_digest(frame, 16, frame.signal[0])},
      {"SIGNAL2", packets_digest(frame, 16, frame.signal[1])},
      {"REFLECTIVITY", packets_digest(frame, 16, frame.reflectivity[0])},
      {"REFLECTIVITY2", packets_digest(frame, 16, frame.reflectivity[1])},
      {"NEAR_IR", packets_digest(frame, 16, frame.near_ir)}};
  for (const auto& [field, value] : by_packet) {
    if (!all["packet_hash"].contains(field)) continue;
    EXPECT_EQ(value, all["packet_hash"][field].get<std::string>()) << field << " by packet";
  }
}

INSTANTIATE_TEST_SUITE_P(Recordings, VendorDigest,
                         testing::Values("OS-0-128-U1_v2.3.0_1024x10", "OS-0-32-U1_v2.2.0_1024x10",
                                         "OS-1-32-G_v2.1.1_1024x10"),
                         [](const auto& param) { return "capture" + std::to_string(param.index); });

struct Xyz {
  const char* pcap;
  const char* metadata;
  const char* csv;
  const char* sums;  ///< name in sums.txt
};

class VendorXyz : public testing::TestWithParam<Xyz> {};

TEST_P(VendorXyz, PointsAreTheVendors) {
  const Xyz& capture = GetParam();
  CA2_NEEDS_PACKETS(packet_file(std::string("ouster/") + capture.pcap));
  const Decoded decoded = decode_capture(capture.pcap, capture.metadata);
  ASSERT_FALSE(decoded.frames.empty());
  const OusterFrame& frame = decoded.frames[0];
  const auto metadata = read_ouster_metadata(packet_file(std::string("ouster/") + capture.metadata));
  ASSERT_TRUE(metadata);
  const OusterGeometry geometry = make_ouster_geometry(*metadata);
  std::map<std::pair<int, int>, Eigen::Vector3f> points;  // row, column
  for (std::size_t i = 0; i < decoded.scans[0].scan.size(); ++i) {
    const Scan& scan = decoded.scans[0].scan;
    points[{scan.ring[i], static_cast<int>(scan.column[i])}] = scan.points[i];
  }

  std::ifstream csv(packet_file(std::string("ouster/expected_xyz/") + capture.csv));
  std::string line;
  std::getline(csv, line);
  int compared = 0;
  while (std::getline(csv, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream in(line);
    int row = 0, column = 0, id = 0;
    std::uint64_t time = 0;
    std::uint32_t range = 0;
    Eigen::Vector3d expected;
    in >> row >> column >> id >> time >> range >> expected.x() >> expected.y() >> expected.z();
    ASSERT_TRUE(in);
    const std::size_t at = static_cast<std::size_t>(column) * frame.rows + row;
    ASSERT_EQ(frame.range[0][at], range) << row << " " << column;
    EXPECT_EQ(frame.timestamp[static_cast<std::size_t>(column)], time);
    ++compared;
    if (range == 0) {
      EXPECT_FALSE(points.contains({row, column}));
      continue;
    }
    EXPECT_LT((geometry.point(row, column, range * 1e-3) - expected).norm(), 1e-7);
    ASSERT_TRUE(points.contains({row, column}));
    EXPECT_LT((points[{row, column}].cast<double>() - expected).norm(), 1e-5);
  }
  EXPECT_GT(compared, 300);

  // The vendor's sums over the whole frame.
  std::ifstream sums(packet_file("ouster/sums.txt"));
  bool found = false;
  while (std::getline(sums, line)) {
    if (!line.starts_with(std::string(capture.sums) + " ")) continue;
    found = true;
    const auto value = [&](const std::string& key) {
      return std::stod(line.substr(line.find(key + "=") + key.size() + 1));
    };
    double range_sum = 0;
    Eigen::Vector3d sum(0, 0, 0);
    int count = 0;
    for (int column = 0; column < frame.columns; ++column) {
      for (int row = 0; row < frame.rows; ++row) {
        const std::uint32_t range = frame.range[0][static_cast<std::size_t>(column) * frame.rows + row];
        if (range == 0) continue;
        ++count;
        range_sum += range;
        sum += geometry.point(row, column, range * 1e-3);
      }
    }
    EXPECT_EQ(count, value("nonzero"));
    EXPECT_EQ(count, static_cast<int>(decoded.scans[0].scan.size()));
    EXPECT_EQ(range_sum, value("sum_range_mm"));
    EXPECT_NEAR(sum.x(), value("sum_xyz_nonzero"), 1e-3);
    const auto valid = std::count_if(frame.status.begin(), frame.status.end(), [](auto s) { return s != 0; });
    EXPECT_EQ(valid, value("valid_cols"));
    EXPECT_EQ(frame.frame_id, value("frame_id"));
  }
  EXPECT_TRUE(found);
}

INSTANTIATE_TEST_SUITE_P(
    Recordings, VendorXyz,
    testing::Values(Xyz{"OS-0-128-U1_v2.3.0_1024x10.pcap", "OS-0-128-U1_v2.3.0_1024x10.json",
                        "OS-0-128-U1_v2.3.0_frame0_xyz.csv", "OS-0-128-U1_v2.3.0"},
                    Xyz{"OS-0-32-U1_v2.2.0_1024x10.pcap", "OS-0-32-U1_v2.2.0_1024x10.json",
                        "OS-0-32-U1_v2.2.0_frame0_xyz.csv", "OS-0-32-U1_v2.2.0"},
                    Xyz{"OS-1-32-G_v2.1.1_1024x10.pcap", "OS-1-32-G_v2.1.1_1024x10.json",
                        "OS-1-32-G_v2.1.1_frame0_xyz.csv", "OS-1-32-G_v2.1.1"},
                    Xyz{"OS-1-64_1024x10_fw20.pcap", "OS-1-64_sensor_config_reduced.json",
                        "OS-1-64_fw20_frame0_xyz.csv", "OS-1-64_fw20"},
                    Xyz{"crc_test.pcap", "crc_test.json", "crc_test_frame0_xyz.csv", "crc_test"},
                    Xyz{"windowed_frame1.pcap", "windowed_frame1_0.json", "windowed_frame1_frame0_xyz.csv",
                        "windowed_frame1"},
                    Xyz{"same_ports_legacy.pcap", "same_ports_legacy.2.json",
                        "same_ports_legacy2_frame0_xyz.csv", "same_ports_legacy2"}),
    [](const auto& param) { return "capture" + std::to_string(param.index); });

TEST(OusterGolden, FusaSecondReturnsAndPartialFrame) {
  CA2_NEEDS_PACKETS(packet_file("ouster/sums.txt"));
  const std::string name = "OS-1-128_767798045_1024x10_20230712_120049";
  const Decoded decoded = decode_capture(name + ".pcap", name + ".json");
  ASSERT_EQ(decoded.frames.size(), 1u);
  const OusterFrame& frame = decoded.frames[0];
  EXPECT_EQ(frame.frame_id, 229u);
  EXPECT_EQ(frame.packets, 8);
  EXPECT_EQ(frame.missing_packets, 56);
  const auto nonzero = [](const std::vector<std::uint32_t>& field) {
    return std::count_if(field.begin(), field.end(), [](std::uint32_t v) { return v != 0; });
  };
  EXPECT_EQ(nonzero(frame.range[0]), 16373);
  EXPECT_EQ(nonzero(frame.range[1]), 1089);
  EXPECT_EQ(decoded.counters.imu_packets, 2u);
}

TEST(OusterGolden, ChecksumsAreCheckedAndWrongOnesCounted) {
  CA2_NEEDS_PACKETS(packet_file("ouster/crc_test.pcap"));
  const Decoded decoded = decode_capture("crc_test.pcap", "crc_test.json");
  ASSERT_EQ(decoded.frames.size(), 2u);  // 254 whole, two packets of 255
  EXPECT_EQ(decoded.frames[1].frame_id, 255u);
  EXPECT_EQ(decoded.counters.checksum_errors, 0u);
  EXPECT_EQ(decoded.counters.lidar_packets, 34u);
  const auto metadata = read_ouster_metadata(packet_file("ouster/crc_test.json"));
  const OusterFormat format = make_ouster_format(*metadata);
  int flipped = 0;
  for (test::Packet packet : test::read_packets(packet_file("ouster/crc_test.pcap"))) {
    if (packet.bytes.size() != format.packet_bytes) continue;
    EXPECT_TRUE(ouster_checksum_fits(format, packet.bytes));
    packet.bytes[1000] ^= 4;
    EXPECT_FALSE(ouster_checksum_fits(format, packet.bytes));
    ++flipped;
  }
  EXPECT_EQ(flipped, 34);
}

TEST(OusterGolden, TwoSensorsAndImuOnOnePortAreToldApart) {
  CA2_NEEDS_PACKETS(packet_file("ouster/same_ports.pcap"));
  for (const auto& [file, frame_id, nonzero] :
       {std::tuple{"same_ports.1.json", 1542u, 1964}, std::tuple{"same_ports.2.json", 883u, 985}}) {
    const Decoded decoded = decode_capture("same_ports.pcap", file);
    ASSERT_EQ(decoded.frames.size(), 1u) << file;
    EXPECT_EQ(decoded.frames[0].frame_id, frame_id);
    const auto& range = decoded.frames[0].range[0];
    EXPECT_EQ(std::count_if(range.begin(), range.end(), [](auto r) { return r != 0; }), nonzero);
    EXPECT_EQ(decoded.counters.imu_packets, 2u);
    EXPECT_EQ(decoded.counters.wrong_size, 1u);  // the other sensor's
  }
}

TEST(OusterGolden, FragmentsWithARepeatedIdentifierAndPacketsThatAreNoLidars) {
  CA2_NEEDS_PACKETS(packet_file("ouster/duplicate_id.pcap"));
  const Decoded duplicate = decode_capture("duplicate_id.pcap", "duplicate_id.json");
  ASSERT_EQ(duplicate.frames.size(), 1u);
  EXPECT_EQ(duplicate.frames[0].frame_id, 1778u);
  EXPECT_EQ(duplicate.scans[0].scan.size(), 1779u);
  const Decoded imu = decode_capture("imu_zm_no_lidar.pcap", "imu_zm_no_lidar_0.json");
  EXPECT_EQ(imu.counters.imu_packets, 8u);
  EXPECT_EQ(imu.counters.zone_packets, 1u);
  EXPECT_TRUE(imu.frames.empty());
  const Decoded foreign = decode_capture("VLI-16-one-packet.pcap", "crc_test.json");
  EXPECT_EQ(foreign.counters.wrong_size, 1u);
  const Decoded single =
      decode_capture("OS-0-32-U1_v2.2.0_1024x10-single-packet.pcap", "OS-0-32-U1_v2.2.0_1024x10.json");
  ASSERT_EQ(single.frames.size(), 1u);
  EXPECT_EQ(single.frames[0].missing_packets, 63);
  EXPECT_TRUE(decode_capture("empty_pcap.pcap", "empty_pcap.json").frames.empty());
}

}  // namespace
}  // namespace ca2
