/// @file Where the recordings of others lie, and reading them.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "drivers/lidar/lidar_driver.h"
#include "drivers/net/pcap_reader.h"

namespace ca2::test {

/// $CA2_TEST_DATA/packets/<name>, or an empty path without the data.
inline std::filesystem::path packet_file(const std::string& name) {
  const char* root = std::getenv("CA2_TEST_DATA");
  return root ? std::filesystem::path(root) / "packets" / name : std::filesystem::path();
}

inline std::string slurp(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// A datagram that owns its bytes.
struct Packet {
  Datagram datagram;
  std::string source;
  std::vector<std::uint8_t> bytes;

  Datagram view() const {
    Datagram out = datagram;
    out.source_address = source;
    out.payload = bytes;
    return out;
  }
};

inline std::vector<Packet> read_packets(const std::filesystem::path& file) {
  std::vector<Packet> packets;
  auto reader = PcapReader::open(file);
  EXPECT_TRUE(reader) << (reader ? "" : reader.error().text());
  while (reader) {
    const Result<PacketBatch> batch = (*reader)->next_batch();
    if (!batch || batch->event == PacketEvent::end) break;
    for (const Datagram& datagram : batch->datagrams) {
      packets.push_back({datagram,
                         std::string(datagram.source_address),
                         {datagram.payload.begin(), datagram.payload.end()}});
    }
  }
  return packets;
}

/// Pushes everything through a driver and collects the scans.
inline std::vector<LidarScan> decode(LidarDriver& driver, const std::vector<Packet>& packets) {
  std::vector<LidarScan> scans;
  const LidarSink sink = [&](LidarScan&& scan) { scans.push_back(std::move(scan)); };
  for (const Packet& packet : packets) driver.push(packet.view(), sink);
  driver.flush(sink);
  return scans;
}

}  // namespace ca2::test

/// Skips a test that needs recordings where they are absent.
#define CA2_NEEDS_PACKETS(file) \
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "set CA2_TEST_DATA to run this on real recordings"
