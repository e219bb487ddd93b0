// What must hold for every model, profile and return mode, those without a public recording included.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <tuple>

#include "drivers/lidar/impair.h"
#include "synthetic.h"

namespace ca2 {
namespace {

using test::SensorSetup;

constexpr std::int64_t start = 1'700'000'000'000'000'000;

class EverySetup : public testing::TestWithParam<SensorSetup> {
 protected:
  std::mt19937_64 random{20240607};

  std::vector<EncoderScan> scans(int count) {
    const BeamTable table = GetParam().table();
    std::vector<EncoderScan> out;
    for (int i = 0; i < count; ++i) {
      out.push_back(
          test::random_scan(table.rings, table.columns, GetParam().quantum(), GetParam().dual(), random));
    }
    return out;
  }
};

/// Returns by ring and column, the first of a pair first.
using Grid = std::multimap<std::pair<int, int>, std::size_t>;
Grid grid_of(const Scan& scan) {
  Grid grid;
  for (std::size_t i = 0; i < scan.size(); ++i)
    grid.emplace(std::pair(scan.ring[i], static_cast<int>(scan.column[i])), i);
  return grid;
}

TEST_P(EverySetup, WhatWasEncodedIsDecoded) {
  const SensorSetup& setup = GetParam();
  const BeamTable table = setup.table();
  const std::vector<EncoderScan> sent = scans(3);
  LidarCounters counters;
  const auto decoder = setup.decoder();
  const auto received = test::decode_packets(*decoder, setup.encode(sent, start, 65534), counters);
  ASSERT_EQ(received.size(), sent.size() + (setup.model->velodyne() && received.size() > 3 ? 1 : 0));
  EXPECT_EQ(counters.missing_packets, 0u);
  EXPECT_EQ(counters.wrong_size + counters.wrong_type + counters.other_sensor + counters.bad_columns +
                counters.checksum_errors + counters.late + counters.duplicates,
            0u);
  // Azimuths on a Velodyne's wire are multiples of 0.01 degree.
  // The head's rate is told from those of one packet: eleven steps, two of a VLS-128, none of one with dual
  // returns; the packet across the seam of two revolutions has a step of another length among them.
  const VelodyneModel* velodyne = setup.model->velodyne();
  const auto tolerance = [&](int column) {
    if (!velodyne) return 2e-7;  // single precision
    const int in_packet = 12 / velodyne->blocks_per_firing() * velodyne->firings_per_block();
    const bool seam = column < in_packet || column >= table.columns - in_packet;
    return (velodyne->lasers > 32 ? 0.016 : 0.012) * (seam ? 4 : 1) * std::numbers::pi / 180;
  };
  for (std::size_t k = 0; k < sent.size(); ++k) {
    const Scan& scan = received[k].scan;
    EXPECT_EQ(scan.rings, table.rings);
    const Grid grid = grid_of(scan);
    std::size_t expected = 0;
    for (int ring = 0; ring < table.rings; ++ring) {
      for (int column = 0; column < table.columns; ++column) {
        const std::size_t at = static_cast<std::size_t>(ring) * table.columns + column;
        if (setup.model->ouster() && !setup.metadata().in_window(column)) continue;
        const double range = sent[k].range[0][at];
        if (!(range > 0)) continue;
        auto found = grid.lower_bound({ring, column});
        ASSERT_TRUE(found != grid.end() && found->first == std::pair(ring, column)) << ring << " " << column;
        const std::size_t i = found->second;
        ++expected;
        ASSERT_NEAR(scan.range[i], range, setup.quantum() * 1e-2) << ring << " " << column;
        ASSERT_EQ(scan.intensity[i], sent[k].reflectivity[0][at]);
        const BeamRay& ray = table.ray(ring, column);
        const Eigen::Vector3d point = ray.origin + range * ray.direction;
        ASSERT_LT((scan.points[i].cast<double>() - point).norm(), range * tolerance(column) + 1e-5)
            << ring << " " << column;
        const double time = static_cast<double>(scan.time[i] - start) * 1e-9 - 0.1 * static_cast<double>(k);
        // A Velodyne packet's stamp is whole microseconds, and its firings run on across the scan's end.
        ASSERT_NEAR(time, table.time[at], setup.model->velodyne() ? 60e-6 : 1e-8);
        const double second = sent[k].range[1].empty() ? 0 : sent[k].range[1][at];
        if (second > 0 && (setup.model->ouster() || second != range)) {
          ++found;
          ++expected;
          ASSERT_TRUE(found != grid.end() && found->first == std::pair(ring, column));
          ASSERT_NEAR(scan.range[found->second], second, setup.quantum() * 1e-2);
          ASSERT_EQ(scan.intensity[found->second], sent[k].reflectivity[1][at]);
        }
      }
    }
    EXPECT_EQ(scan.size(), expected);
    if (setup.model->ouster()) {
      const std::uint64_t modulus = setup.metadata().fusa_header ? std::uint64_t{1} << 32 : 65536;
      EXPECT_EQ(received[k].frame_id, (65534 + k) % modulus);
    }
  }
}

/// A return, whatever scan it is in.
using Return = std::tuple<int, std::int64_t, float, float, float, float, float>;
std::vector<Return> returns_of(const std::vector<LidarScan>& scans) {
  std::vector<Return> out;
  for (const LidarScan& scan : scans) {
    const Scan& s = scan.scan;
    for (std::size_t i = 0; i < s.size(); ++i) {
      // Times to 2 us: where the firing cycle is measured, what is lost changes it by a nanosecond.
      out.emplace_back(s.ring[i], s.time[i] / 2000, s.range[i], s.intensity[i], s.points[i].x(),
                       s.points[i].y(), s.points[i].z());
    }
  }
  std::sort(out.begin(), out.end());
  return out;
}

TEST_P(EverySetup, LossDuplicationAndDisorderLeaveWhatSurvivesRightAndInventNothing) {
  const SensorSetup& setup = GetParam();
  const auto packets = setup.encode(scans(3), start, 100);
  LidarCounters counters;
  const auto all = returns_of(test::decode_packets(*setup.decoder(), packets, counters));
  for (const std::size_t reorder : {std::size_t{0}, std::size_t{4}}) {
    const auto arrived = impair(packets, {0.5, 0.2, reorder}, random);
    // Each surviving packet alone, in order and once, is the truth to compare with.
    std::vector<EncodedPacket> survivors;
    for (const EncodedPacket& packet : packets) {
      const auto same = [&](const EncodedPacket& other) { return other.bytes == packet.bytes; };
      if (std::any_of(arrived.begin(), arrived.end(), same)) survivors.push_back(packet);
    }
    LidarCounters lossy;
    const auto received = test::decode_packets(*setup.decoder(), arrived, lossy);
    const auto got = returns_of(received);
    std::size_t invented = 0, moved = 0;
    for (const Return& r : got) {
      // The firing of a VLS-128 with dual returns fills a packet: its azimuth step is that of its neighbours.
      const auto near = [&](const Return& t) {
        const auto distance = std::hypot(std::get<4>(r) - std::get<4>(t), std::get<5>(r) - std::get<5>(t));
        return std::get<0>(r) == std::get<0>(t) && std::abs(std::get<1>(r) - std::get<1>(t)) <= 1 &&
               std::get<2>(r) == std::get<2>(t) && std::get<3>(r) == std::get<3>(t) && distance < 5e-2;
      };
      if (std::binary_search(all.begin(), all.end(), r)) continue;
      const auto from =
          std::lower_bound(all.begin(), all.end(), Return{std::get<0>(r), std::get<1>(r) - 1, 0, 0, 0, 0, 0});
      const auto to =
          std::upper_bound(all.begin(), all.end(), Return{std::get<0>(r), std::get<1>(r) + 2, 0, 0, 0, 0, 0});
      ++(std::any_of(from, to, near) ? moved : invented);
    }
    EXPECT_EQ(invented, 0u);
    EXPECT_EQ(lossy.lidar_packets, survivors.size());
    EXPECT_EQ(lossy.late, 0u);
    EXPECT_EQ(lossy.duplicates, arrived.size() - survivors.size());
    LidarCounters orderly;
    EXPECT_EQ(got.size(), returns_of(test::decode_packets(*setup.decoder(), survivors, orderly)).size());
    if (setup.name != "VLS_128_dual" && setup.name.find("VLS") == std::string::npos &&
        setup.name.find("HDL_64E") == std::string::npos) {
      EXPECT_EQ(moved, 0u);
    }
  }
}

TEST_P(EverySetup, TruncatedAtEveryByteItIsCountedAndNothingElse) {
  const SensorSetup& setup = GetParam();
  const auto packets = setup.encode(scans(1), start, 7);
  const EncodedPacket& whole = packets[packets.size() / 2];
  const auto decoder = setup.decoder();
  LidarCounters counters;
  std::uint64_t given = 0;
  const LidarSink sink = [&](LidarScan&&) { ++given; };
  std::uint64_t pushed = 0;
  for (std::size_t size = 0; size < whole.bytes.size(); ++size) {
    // Of its own allocation, so that the sanitizer sees a byte too far.
    const std::vector<std::uint8_t> cut(whole.bytes.begin(),
                                        whole.bytes.begin() + static_cast<std::ptrdiff_t>(size));
    Datagram datagram;
    datagram.payload = cut;
    decoder->push(datagram, counters, sink);
    ++pushed;
  }
  decoder->flush(counters, sink);
  EXPECT_EQ(given, 0u);
  EXPECT_EQ(counters.lidar_packets, 0u);
  EXPECT_EQ(counters.wrong_size + counters.imu_packets + counters.position_packets + counters.zone_packets,
            pushed);
}

TEST_P(EverySetup, DamagedPacketsNeitherCrashNorBlock) {
  const SensorSetup& setup = GetParam();
  const auto packets = setup.encode(scans(2), start, 7);
  const auto decoder = setup.decoder();
  LidarCounters counters;
  std::size_t points = 0;
  const LidarSink sink = [&](LidarScan&& scan) {
    points += scan.scan.size();
    ASSERT_EQ(scan.scan.size(), scan.scan.time.size());
    for (const Eigen::Vector3f& point : scan.scan.points) ASSERT_TRUE(point.allFinite());
    for (const std::uint16_t ring : scan.scan.ring) ASSERT_LT(ring, scan.scan.rings);
    if (scan.scan.columns > 0) {
      for (const std::uint32_t column : scan.scan.column)
        ASSERT_LT(column, static_cast<unsigned>(scan.scan.columns));
    }
  };
  for (const EncodedPacket& packet : packets) {
    std::vector<std::uint8_t> bytes = packet.bytes;
    for (int flips = 0; flips < 6; ++flips)
      bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    if (random() % 8 == 0) {
      for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    }
    if (random() % 16 == 0) std::fill(bytes.begin(), bytes.end(), std::uint8_t{0});
    Datagram datagram;
    datagram.time = packet.time;
    datagram.payload = bytes;
    decoder->push(datagram, counters, sink);
  }
  decoder->flush(counters, sink);
  SUCCEED() << points;
}

INSTANTIATE_TEST_SUITE_P(Registry, EverySetup, testing::ValuesIn(test::setups()),
                         [](const auto& param) { return param.param.name; });

}  // namespace
}  // namespace ca2
