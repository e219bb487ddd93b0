/// @file Scans on the host's clock.
#include "drivers/lidar/scan_clock.h"

#include <gtest/gtest.h>

namespace ca2 {
namespace {

constexpr std::int64_t ms = 1'000'000;
constexpr std::int64_t offset = 1'700'000'000'000'000'000;  // ns, host minus device

/// A revolution of 100 ms in packets of 10 ms; nothing came back in its last 30 ms.
LidarScan revolution(std::int64_t start) {
  LidarScan scan;
  for (int packet = 0; packet < 10; ++packet) {
    const std::int64_t device = start + packet * 10 * ms;
    scan.clock.push_back({device, device + offset});
    if (packet >= 7) continue;
    scan.scan.points.emplace_back(1.f, 0.f, 0.f);
    scan.scan.time.push_back(device);
  }
  return scan;
}

TEST(ScanClock, TimesAreTheHosts) {
  ScanClock clock;
  for (int turn = 0; turn < 30; ++turn) {
    const auto timed = clock.map(revolution(turn * 100 * ms));
    ASSERT_TRUE(timed);
    // The middle between the first and the last packet, whatever came back.
    EXPECT_NEAR(static_cast<double>(timed->time - offset - turn * 100 * ms), 45e6, 1e5);
    EXPECT_NEAR(static_cast<double>(timed->scan->time.front() - offset - turn * 100 * ms), 0, 1e5);
    EXPECT_GT(timed->time_sigma, 0);
    EXPECT_FALSE(timed->clock_jumped);
  }
}

TEST(ScanClock, ARestartedSensorIsFollowed) {
  ScanClock clock;
  for (int turn = 100; turn < 130; ++turn) clock.map(revolution(turn * 100 * ms));
  LidarScan scan = revolution(0);
  for (ClockSample& sample : scan.clock) sample.host += 13'000 * ms;  // time went on
  const auto timed = clock.map(std::move(scan));
  ASSERT_TRUE(timed);
  EXPECT_TRUE(timed->clock_jumped);
  EXPECT_NEAR(static_cast<double>(timed->time - offset - 13'000 * ms), 45e6, 1e6);
}

TEST(ScanClock, NothingWithoutPackets) {
  ScanClock clock;
  EXPECT_FALSE(clock.map(LidarScan()));
}

}  // namespace
}  // namespace ca2
