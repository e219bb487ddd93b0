/// @file decode as a person runs it, on recordings made by the encoders.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/io/files.h"
#include "drivers/lidar/encode.h"
#include "drivers/lidar/model.h"
#include "drivers/net/pcap_writer.h"
#include "tests/tools/ca2/program.h"
#include "tests/tools/ca2/small_session.h"

namespace ca2 {
namespace {

using namespace ca2::test;
namespace fs = std::filesystem;

class DecodeCommand : public testing::Test {
 protected:
  fs::path folder = fs::temp_directory_path() / ("ca2_decode_" + std::to_string(::getpid()));

  void SetUp() override { fs::create_directories(folder); }
  void TearDown() override { fs::remove_all(folder); }

  /// `sources`: the packets' addresses, in turns.
  void write_capture(const std::vector<EncodedPacket>& packets, std::uint16_t port,
                     const std::vector<std::string>& sources = {"192.0.2.7"}) {
    PcapWriterOptions options;
    options.overwrite = true;
    auto writer = PcapWriter::create(folder / "in.pcap", options);
    ASSERT_TRUE(writer) << writer.error().text();
    std::size_t number = 0;
    for (const EncodedPacket& packet : packets) {
      Datagram datagram;
      datagram.time = packet.time;
      datagram.source_address = sources[number++ % sources.size()];
      datagram.destination_port = port;
      datagram.payload = packet.bytes;
      ASSERT_TRUE(writer->write(datagram));
    }
    ASSERT_TRUE(writer->close());
  }

  /// A wall of returns that get further by a step from ring to ring.
  static std::vector<EncodedPacket> puck_packets(int scans) {
    return velodyne_packets("VLP-16", 0, 1808, scans);
  }

  static std::vector<EncodedPacket> velodyne_packets(const char* name, std::uint8_t product_id, int columns,
                                                     int scans) {
    const VelodyneModel& model = *(*find_lidar_model(name))->velodyne();
    VelodyneEncoding encoding;
    encoding.product_id = product_id;
    VelodyneEncoder encoder(model, model.factory, encoding);
    std::vector<EncodedPacket> packets;
    for (int i = 0; i < scans; ++i) {
      const std::int64_t start = 1'700'000'000'000'000'000 + i * 100'000'000;
      for (auto& packet : encoder.push(scan(model.lasers, columns, start))) {
        packets.push_back(std::move(packet));
      }
    }
    return packets;
  }

  static EncoderScan scan(int rings, int columns, std::int64_t start) {
    EncoderScan out;
    out.rings = rings;
    out.columns = columns;
    out.start = start;
    for (int ring = 0; ring < rings; ++ring) {
      out.range[0].insert(out.range[0].end(), static_cast<std::size_t>(columns),
                          5.0f + 0.008f * static_cast<float>(ring));
    }
    out.range[0][3] = 0;  // one without a return
    return out;
  }
};

TEST_F(DecodeCommand, AnOusterRecordingBecomesRowsToTheMicrometre) {
  const OusterMetadata metadata =
      nominal_ouster_metadata(*(*find_lidar_model("OS1-32"))->ouster(), 512, 10, "RNG19_RFL8_SIG16_NIR16");
  std::ofstream(folder / "meta.json") << write_ouster_metadata(metadata);
  constexpr std::int64_t start = 1'700'000'000'000'000'000;
  write_capture(encode_ouster(metadata, scan(32, 512, start)), 7502);
  const Outcome outcome = run_ca2({"decode", folder / "in.pcap", "--metadata", folder / "meta.json",
                                   "--output", folder / "out", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.errors;
  const auto summary = nlohmann::json::parse(outcome.output);
  EXPECT_EQ(summary["scans"], 1);
  EXPECT_EQ(summary["points"], 32 * 512 - 1);
  EXPECT_EQ(summary["counters"]["lidar_packets"], 32);

  const auto table = make_beam_table({"", folder / "meta.json", {}, 0, 0});
  ASSERT_TRUE(table);
  std::FILE* csv = std::fopen((folder / "out" / "scans.csv").c_str(), "r");
  ASSERT_NE(csv, nullptr);
  char line[256];
  ASSERT_NE(std::fgets(line, sizeof line, csv), nullptr);
  EXPECT_STREQ(line, "scan,ring,column,timestamp_ns,range_m,x,y,z,intensity\n");
  int rows = 0;
  while (std::fgets(line, sizeof line, csv)) {
    int number = 0, ring = 0, column = 0;
    long long time = 0;
    double range = 0, intensity = 0;
    Eigen::Vector3d point;
    ASSERT_EQ(std::sscanf(line, "%d,%d,%d,%lld,%lf,%lf,%lf,%lf,%lf", &number, &ring, &column, &time, &range,
                          &point.x(), &point.y(), &point.z(), &intensity),
              9);
    EXPECT_NEAR(range, 5 + 0.008 * ring, 1e-9);
    const BeamRay& ray = table->ray(ring, column);
    ASSERT_LT((point - (ray.origin + range * ray.direction)).norm(), 2e-8);
    EXPECT_EQ(time, start + std::llround(column * 1e9 / 5120));
    EXPECT_EQ(intensity, 100);
    ++rows;
  }
  std::fclose(csv);
  EXPECT_EQ(rows, 32 * 512 - 1);
}

TEST_F(DecodeCommand, AVelodyneRecordingBecomesCloudsAndAnHdl64eWithoutAnglesIsRefused) {
  write_capture(puck_packets(2), 2368);
  const Outcome outcome = run_ca2(
      {"decode", folder / "in.pcap", "--model", "vlp16", "--format", "pcd", "--output", folder / "out"});
  ASSERT_EQ(outcome.status, 0) << outcome.errors;
  EXPECT_NE(outcome.output.find("VLP-16: 2 scans"), std::string::npos) << outcome.output;
  const auto cloud = read_pcd(folder / "out" / "000000.pcd");
  ASSERT_TRUE(cloud) << cloud.error().text();
  EXPECT_EQ(cloud->size(), 16u * 1808 - 1);
  EXPECT_TRUE(fs::exists(folder / "out" / "000001.pcd"));

  const auto status = [&](std::vector<std::string> options) {
    std::vector<std::string> all{"decode", folder / "in.pcap", "--output", folder / "out"};
    all.insert(all.end(), options.begin(), options.end());
    return run_ca2(all).status;
  };
  EXPECT_EQ(status({"--model", "HDL-64E"}), 78);
  EXPECT_EQ(status({"--model", "VLP-17"}), 78);
  EXPECT_EQ(status({"--model", "VLS-128"}), 65);  // nothing of it in there
  EXPECT_EQ(status({}), 64);
  EXPECT_EQ(status({"--model", "VLP-16", "--format", "las"}), 64);
  EXPECT_EQ(status({"--model", "VLP-16", "--source", "lidar.local"}), 64);
  EXPECT_EQ(status({"--model", "VLP-16", "--metadata", "x.json"}), 64);
}

TEST_F(DecodeCommand, TwoSensorsOnOnePortAreNotWovenIntoOne) {
  std::vector<EncodedPacket> packets = puck_packets(2), both;
  write_capture(packets, 2368);
  const std::vector<std::string> decode{"decode", folder / "in.pcap", "--model",
                                        "VLP-16", "--output",         folder / "out"};
  const Outcome alone = run_ca2(decode);
  ASSERT_EQ(alone.status, 0) << alone.errors;
  EXPECT_EQ(alone.errors, "");
  const std::string rows = bytes_of(folder / "out" / "scans.csv");
  // The second one's revolutions are a third of a turn off.
  for (std::size_t i = 0; i < packets.size(); ++i) {
    both.push_back(packets[i]);
    both.push_back(packets[(i + packets.size() / 3) % packets.size()]);
    both.back().time = packets[i].time + 300'000;
  }
  write_capture(both, 2368, {"192.0.2.7", "192.0.2.8"});
  const Outcome mixed = run_ca2(decode);
  EXPECT_EQ(mixed.status, 0);
  EXPECT_EQ(bytes_of(folder / "out" / "scans.csv"), rows);
  EXPECT_NE(
      mixed.errors.find("in.pcap: warning: has packets of several addresses, and only those of 192.0.2.7"),
      std::string::npos)
      << mixed.errors;
  std::vector<std::string> asked = decode;
  asked.insert(asked.end(), {"--source", "192.0.2.7"});
  EXPECT_EQ(run_ca2(asked).errors, "") << "the others are left out on purpose";
}

TEST_F(DecodeCommand, ModelsThatShareANumberAreToldApartByTheirPace) {
  const auto scans = [&](const char* model) {
    const Outcome run =
        run_ca2({"decode", folder / "in.pcap", "--model", model, "--output", folder / "out", "--json"});
    EXPECT_EQ(run.status, run.errors.empty() ? 0 : 65) << run.errors;
    return nlohmann::json::parse(run.output)["scans"].get<int>();
  };
  std::vector<EncodedPacket> packets = velodyne_packets("HDL-32E", 0x21, 2170, 3);
  write_capture(packets, 2368);
  EXPECT_EQ(scans("HDL-32E"), 3);
  EXPECT_EQ(scans("VLP-16"), 0);
  packets = velodyne_packets("VLP-16", 0x21, 1808, 3);
  write_capture(packets, 2368);
  EXPECT_EQ(scans("VLP-16"), 3);
  EXPECT_EQ(scans("HDL-32E"), 0);
  // Half of the packets lost: gaps are no pace.
  for (std::size_t i = 0; i < packets.size(); ++i) packets.erase(packets.begin() + static_cast<long>(i));
  write_capture(packets, 2368);
  EXPECT_EQ(scans("VLP-16"), 3);
  EXPECT_EQ(scans("HDL-32E"), 0);
}

TEST_F(DecodeCommand, ACaptureThatEndsInARecordIsSaidToAndOneOfAnotherSensorLeavesEarlierRowsAlone) {
  write_capture(puck_packets(2), 2368);
  fs::resize_file(folder / "in.pcap", fs::file_size(folder / "in.pcap") - 100);
  const Outcome cut =
      run_ca2({"decode", folder / "in.pcap", "--model", "VLP-16", "--output", folder / "out"});
  EXPECT_EQ(cut.status, 0);
  EXPECT_NE(cut.errors.find("in.pcap: warning: ends in the middle of a record"), std::string::npos)
      << cut.errors;
  const std::string rows = bytes_of(folder / "out" / "scans.csv");
  EXPECT_GT(rows.size(), 1'000'000u);

  const Outcome other =
      run_ca2({"decode", folder / "in.pcap", "--model", "VLS-128", "--output", folder / "out"});
  EXPECT_EQ(other.status, 65);
  EXPECT_NE(other.errors.find("no scan of this sensor, VLS-128, is in it: "), std::string::npos)
      << other.errors;
  EXPECT_NE(other.errors.find(" dropped: serial number or model of another sensor;"), std::string::npos)
      << other.errors;
  EXPECT_EQ(bytes_of(folder / "out" / "scans.csv"), rows);
}

}  // namespace
}  // namespace ca2
