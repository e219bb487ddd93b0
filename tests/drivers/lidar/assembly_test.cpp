// The state machines on their own: frames by number, packets by time, revolutions by azimuth.
#include <gtest/gtest.h>

#include <algorithm>

#include "synthetic.h"

namespace ca2 {
namespace {

using test::SensorSetup;

SensorSetup ouster(const std::string& profile = "RNG15_RFL8_NIR8") {
  return {"ouster", *find_lidar_model("OS1-16"), profile, 0, -1, 0};
}

std::vector<EncodedPacket> frames(const SensorSetup& setup, int count, std::uint32_t first) {
  std::mt19937_64 random(3);
  std::vector<EncoderScan> scans;
  const BeamTable table = setup.table();
  for (int i = 0; i < count; ++i)
    scans.push_back(test::random_scan(table.rings, table.columns, 0.008, false, random));
  return setup.encode(scans, 1'000'000'000, first);
}

struct Decoded {
  LidarCounters counters;
  std::vector<LidarScan> scans;
};
Decoded decode_all(const SensorSetup& setup, const std::vector<EncodedPacket>& packets) {
  Decoded out;
  out.scans = test::decode_packets(*setup.decoder(), packets, out.counters);
  return out;
}

TEST(OusterAssembly, FrameNumbersWrap) {
  for (const char* profile : {"LEGACY", "RNG15_RFL8_NIR8", "FUSA_RNG15_RFL8_NIR8_DUAL"}) {
    const bool fusa = std::string(profile).starts_with("FUSA");
    const Decoded result =
        decode_all(ouster(profile), frames(ouster(profile), 4, fusa ? 0xFFFFFFFEu : 65534u));
    ASSERT_EQ(result.scans.size(), 4u) << profile;
    EXPECT_EQ(result.scans[2].frame_id, 0u);
    EXPECT_EQ(result.counters.incomplete_frames, 0u);
    EXPECT_EQ(result.counters.late, 0u);
  }
}

TEST(OusterAssembly, FramesThatOverlapAreKeptApart) {
  auto packets = frames(ouster(), 2, 10);
  ASSERT_EQ(packets.size(), 64u);
  std::rotate(packets.begin() + 30, packets.begin() + 32, packets.begin() + 36);  // 2 + 4 packets swap places
  const Decoded result = decode_all(ouster(), packets);
  ASSERT_EQ(result.scans.size(), 2u);
  EXPECT_TRUE(result.scans[0].complete);
  EXPECT_TRUE(result.scans[1].complete);
  EXPECT_EQ(result.scans[0].frame_id, 10u);
}

TEST(OusterAssembly, AFrameWithAHoleGoesOutSoonAfterTheNextBegins) {
  auto packets = frames(ouster(), 2, 10);
  packets.erase(packets.begin() + 5);
  LidarCounters counters;
  const auto decoder = ouster().decoder();
  std::size_t pushed = 0, given = 0;
  const LidarSink sink = [&](LidarScan&&) {
    EXPECT_EQ(pushed, given == 0 ? 31u + 8u : 63u);
    ++given;
  };
  for (const EncodedPacket& packet : packets) {
    ++pushed;
    Datagram datagram;
    datagram.payload = packet.bytes;
    decoder->push(datagram, counters, sink);
  }
  EXPECT_EQ(given, 2u);
  EXPECT_EQ(counters.missing_packets, 1u);
  EXPECT_EQ(counters.incomplete_frames, 1u);
}

TEST(OusterAssembly, ARestartedCounterIsFollowed) {
  auto packets = frames(ouster("LEGACY"), 3, 5000);
  for (EncodedPacket& packet : frames(ouster("LEGACY"), 4, 1)) packets.push_back(std::move(packet));
  const Decoded result = decode_all(ouster("LEGACY"), packets);
  EXPECT_EQ(result.counters.restarts, 1u);
  ASSERT_GE(result.scans.size(), 5u);
  EXPECT_EQ(result.scans.back().frame_id, 4u);
  EXPECT_TRUE(result.scans.back().complete);
}

TEST(OusterAssembly, PacketsOfOtherSensorsAndOtherTimesAreNotMixedIn) {
  auto packets = frames(ouster(), 1, 5);
  packets[3].bytes[7] ^= 1;    // serial number
  packets[4].bytes[4] ^= 1;    // initialisation id
  packets[5].bytes[0] = 9;     // type
  packets[6].bytes[100] ^= 1;  // data: the CRC sees it
  std::fill(packets[7].bytes.begin(), packets[7].bytes.end(), std::uint8_t{0});
  const Decoded result = decode_all(ouster(), packets);
  EXPECT_EQ(result.counters.other_sensor, 1u);
  EXPECT_EQ(result.counters.reinitialised, 1u);
  EXPECT_EQ(result.counters.wrong_type, 2u);
  EXPECT_EQ(result.counters.checksum_errors, 1u);
  ASSERT_EQ(result.scans.size(), 1u);
  EXPECT_EQ(result.scans[0].missing_packets, 5);
}

TEST(VelodyneCutter, JitterDoesNotCutAndLossDoesNotHideARevolution) {
  VelodyneScanCutter cutter(0);
  EXPECT_FALSE(cutter.begins(35000));
  EXPECT_FALSE(cutter.begins(35990));
  EXPECT_TRUE(cutter.begins(5));
  EXPECT_FALSE(cutter.begins(35999));  // back by a hair
  EXPECT_FALSE(cutter.begins(10));
  EXPECT_FALSE(cutter.begins(9));
  EXPECT_FALSE(cutter.begins(20000));
  EXPECT_TRUE(cutter.begins(8000));  // two thirds of a revolution lost
  EXPECT_TRUE(cutter.begins(9000, 37000));
  VelodyneScanCutter elsewhere(9000);
  EXPECT_FALSE(elsewhere.begins(8900));
  EXPECT_TRUE(elsewhere.begins(9010));
  EXPECT_FALSE(elsewhere.begins(5));
  EXPECT_EQ(elsewhere.past_cut(9010), 10);
}

/// A packet with nothing but a time stamp.
std::vector<std::uint8_t> stamped(std::uint32_t us) {
  std::vector<std::uint8_t> bytes(VelodynePacket::bytes);
  store(bytes.data() + 1200, us);
  return bytes;
}

TEST(VelodynePacketOrder, TimeGoesOnAcrossTheHourAndAcrossJumps) {
  VelodynePacketOrder order;
  LidarCounters counters;
  std::vector<std::int64_t> times;
  int restarts = 0;
  const auto sink = [&](const OrderedPacket& packet) {
    times.push_back(packet.device_time);
    restarts += packet.restart;
  };
  const std::int64_t hour = 3'600'000'000'000;
  std::int64_t host = 470'000 * hour - 10'000'000;
  std::uint32_t stamp = 3'599'990'000u;
  const auto push = [&](int count) {
    for (int i = 0; i < count; ++i) {
      order.push(stamped(stamp).data(), host, 1000e-6, counters, sink);
      stamp = (stamp + 1000) % 3'600'000'000u;
      host += 1'000'000;
    }
  };
  push(20);
  order.flush(counters, sink);
  ASSERT_EQ(times.size(), 20u);
  EXPECT_EQ(times[0], 470'000 * hour - 10'000'000);
  for (std::size_t i = 1; i < times.size(); ++i) EXPECT_EQ(times[i] - times[i - 1], 1'000'000);
  push(12);
  stamp = 1'000'000'000;  // the clock is set
  push(12);
  order.flush(counters, sink);
  EXPECT_EQ(restarts, 1);
  EXPECT_EQ(counters.restarts, 1u);
  EXPECT_EQ(times.size(), 44u);
  EXPECT_EQ(counters.late + counters.duplicates + counters.missing_packets, 0u);
}

TEST(VelodynePacket, ConfidenceBlocksAreNoReturnsAndOtherLayoutsAreRefused) {
  const SensorSetup setup{"vlp32c", *find_lidar_model("VLP-32C"), "", 0, -1, 0x37};
  std::mt19937_64 random(8);
  const BeamTable table = setup.table();
  auto packets = setup.encode({test::random_scan(32, table.columns, 0.004, false, random)}, 0, 0);
  packets.resize(4);
  auto triples = packets;
  for (EncodedPacket& packet : triples) {
    packet.bytes[1204] = 0x3B;
    for (int block = 0; block < 12; ++block) {  // three blocks of one firing share its azimuth
      std::copy_n(packet.bytes.begin() + block / 3 * 300 + 2, 2, packet.bytes.begin() + block * 100 + 2);
    }
  }
  const Decoded accepted = decode_all(setup, triples);
  EXPECT_EQ(accepted.counters.lidar_packets, 4u);
  ASSERT_EQ(accepted.scans.size(), 1u);
  // Four firings of every twelve: the time stamps are still those of single returns.
  EXPECT_EQ(accepted.scans[0].scan.columns, 3 * 12 + 4);
  EXPECT_LE(accepted.scans[0].scan.size(), 4u * 4 * 2 * 32);
  for (EncodedPacket& packet : packets) packet.bytes[1204] = 0x3B;
  EXPECT_EQ(decode_all(setup, packets).counters.unknown_return_mode, 4u);
}

TEST(VelodyneDecoder, AFiringCycleOfOtherFirmwareIsMeasured) {
  for (const auto& [name, factor] : {std::pair{"HDL-64E-nominal", 1.2}, std::pair{"VLS-128", 55.3 / 53.3}}) {
    const VelodyneModel& known = *(*find_lidar_model(name))->velodyne();
    VelodyneModel slower = known;
    slower.cycle *= factor;
    for (double& time : slower.firing) time *= factor;
    std::mt19937_64 random(4);
    const int columns = static_cast<int>(0.1 / slower.cycle);
    EncoderScan scan = test::random_scan(known.lasers, columns, known.distance_lsb, false, random);
    VelodyneEncoder encoder(slower, known.factory, {});
    VelodyneDecoder decoder(known, known.factory, {});
    LidarCounters counters;
    const auto scans = test::decode_packets(decoder, encoder.push(scan), counters);
    ASSERT_EQ(scans.size(), 1u) << name;
    EXPECT_EQ(counters.missing_packets, 0u);
    const Scan& out = scans[0].scan;
    const std::vector<int> rings = velodyne_rings(known.factory);
    for (std::size_t i = out.size() / 2; i < out.size(); i += 101) {
      const auto laser = std::find(rings.begin(), rings.end(), out.ring[i]) - rings.begin();
      const double expected = out.column[i] * slower.cycle + slower.firing[static_cast<std::size_t>(laser)];
      EXPECT_NEAR(static_cast<double>(out.time[i]) * 1e-9, expected, 1.5e-6) << name;
    }
  }
}

TEST(VelodyneDecoder, TheTwoPointCorrectionIsForNearPointsOnly) {
  const VelodyneModel& model = *(*find_lidar_model("HDL-64E-nominal"))->velodyne();
  VelodyneCalibration calibration = model.factory;
  for (VelodyneLaser& laser : calibration.lasers) {
    laser.distance_x = laser.distance + 0.05;
    laser.distance_y = laser.distance + 0.03;
  }
  std::mt19937_64 random(6);
  VelodyneEncoder encoder(model, calibration, {});
  const auto packets = encoder.push(test::random_scan(64, 500, 0.002, false, random));
  VelodyneOptions corrected;
  corrected.two_point_correction = true;
  VelodyneDecoder plain_decoder(model, calibration, {}), corrected_decoder(model, calibration, corrected);
  LidarCounters counters;
  const Scan plain = test::decode_packets(plain_decoder, packets, counters).at(0).scan;
  const Scan near = test::decode_packets(corrected_decoder, packets, counters).at(0).scan;
  ASSERT_EQ(plain.size(), near.size());
  int moved = 0;
  for (std::size_t i = 0; i < plain.size(); ++i) {
    const float distance = (plain.points[i] - near.points[i]).norm();
    if (plain.range[i] >= 25.04f) {
      EXPECT_EQ(distance, 0);
    } else {
      EXPECT_LT(distance, 0.08f);
      moved += distance > 1e-3f;
    }
  }
  EXPECT_GT(moved, 1000);
}

}  // namespace
}  // namespace ca2
