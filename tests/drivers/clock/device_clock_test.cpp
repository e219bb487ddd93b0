#include "drivers/clock/device_clock.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace ca2 {
namespace {

constexpr std::int64_t ms = 1'000'000, s = 1'000'000'000;

/// A sensor on a network: packets leave at even device times and arrive late by chance.
struct World {
  double drift = 0;                               ///< host per device, minus 1
  std::int64_t offset = 1'700'000'000 * s;        ///< host time at device time 0
  double least_delay = 80'000, jitter = 200'000;  ///< ns; exponential above the least
  double spikes = 0.02, spike = 30e6;             ///< share and mean length of long delays, ns
  std::mt19937_64 random{4};

  std::int64_t sent(std::int64_t device) const {
    return offset + device + static_cast<std::int64_t>(static_cast<double>(device) * drift);
  }
  std::int64_t received(std::int64_t device) {
    std::exponential_distribution<double> exponential(1);
    double delay = least_delay + jitter * exponential(random);
    if (std::uniform_real_distribution<double>()(random) < spikes) delay += spike * exponential(random);
    return sent(device) + static_cast<std::int64_t>(delay);
  }
};

struct DriftCase {
  double drift;
  std::int64_t period;  ///< ns between packets
  double jitter;        ///< ns
};

class Drifts : public testing::TestWithParam<DriftCase> {};

// Errors against what is stated: the map is right within its sigma, and the sigma is not idle either.
TEST_P(Drifts, AreFollowedWithinTheStatedUncertainty) {
  double sum_of_squares = 0, worst = 0, drift_worst = 0, sigma_end = 0;
  int looks = 0;
  for (unsigned seed = 0; seed < 8; ++seed) {
    World world;
    world.random.seed(seed);
    world.drift = GetParam().drift;
    world.jitter = GetParam().jitter;
    DeviceClock clock;
    const std::int64_t start = 50 * s;
    for (std::int64_t device = start; device < start + 60 * s; device += GetParam().period) {
      clock.update(device, world.received(device));
      if ((device - start) / GetParam().period % 97 != 96) continue;
      const ClockMapping& mapping = *clock.mapping();
      const auto error = static_cast<double>(mapping.to_host(device) - world.sent(device));
      const double ratio = error / mapping.sigma_ns(device);
      sum_of_squares += ratio * ratio;
      worst = std::max(worst, std::abs(ratio));
      ++looks;
    }
    const ClockMapping& mapping = *clock.mapping();
    drift_worst = std::max(drift_worst, std::abs(mapping.drift - world.drift) / mapping.sigma_drift);
    sigma_end = std::max(sigma_end, mapping.sigma_ns(start + 60 * s));
    EXPECT_EQ(clock.jumps(), 0u);
  }
  const double rms = std::sqrt(sum_of_squares / looks);
  RecordProperty("rms_of_error_by_sigma", std::to_string(rms));
  EXPECT_LT(rms, 1.3);
  EXPECT_GT(rms, 0.1);
  EXPECT_LT(worst, 4);
  EXPECT_LT(drift_worst, 4);
  EXPECT_LT(sigma_end, 0.3 * ms);
}

INSTANTIATE_TEST_SUITE_P(All, Drifts,
                         testing::Values(DriftCase{0, 1'562'500, 200'000},      // OS at 640 packets/s
                                         DriftCase{80e-6, 1'327'000, 200'000},  // VLP-16, one crystal off
                                         DriftCase{-80e-6, 1'327'000, 200'000},
                                         DriftCase{30e-6, 160'000, 50'000},      // VLS-128, a quiet wire
                                         DriftCase{-30e-6, 10 * ms, 1'000'000},  // IMU packets, a loaded host
                                         DriftCase{0, 1'562'500, 0}));           // no jitter at all

TEST(DeviceClock, HasNoMappingBeforeTheFirstPacketAndAWideOneAfterIt) {
  DeviceClock clock;
  EXPECT_FALSE(clock.mapping());
  EXPECT_EQ(clock.update(5 * s, 100 * s), DeviceClock::Update::first);
  ASSERT_TRUE(clock.mapping());
  EXPECT_EQ(clock.mapping()->to_host(5 * s), 100 * s);
  EXPECT_EQ(clock.mapping()->to_host(6 * s), 101 * s);
  EXPECT_GE(clock.mapping()->sigma_ns(5 * s), 1 * ms);
  EXPECT_GT(clock.mapping()->sigma_ns(605 * s), clock.mapping()->sigma_ns(5 * s) * 5)
      << "the drift is not known";
}

TEST(DeviceClock, NoticesARestartAtOnce) {
  World world;
  DeviceClock clock;
  std::int64_t device = 100 * s;
  for (; device < 110 * s; device += 2 * ms) clock.update(device, world.received(device));
  const std::int64_t host = world.sent(device) + 30 * s;  // booted again, counting from zero
  EXPECT_EQ(clock.update(1 * s, host), DeviceClock::Update::jump);
  EXPECT_EQ(clock.jumps(), 1u);
  EXPECT_EQ(clock.mapping()->to_host(1 * s), host);
  EXPECT_EQ(clock.update(1 * s + 2 * ms, host + 2 * ms), DeviceClock::Update::regular);
}

TEST(DeviceClock, NoticesAClockSetForwardAtOnceAndOneSetBackSoon) {
  for (const std::int64_t step : {37 * s, -200 * ms}) {  // PTP comes up: TAI; a small correction
    World world;
    DeviceClock clock;
    std::int64_t device = 100 * s;
    for (; device < 110 * s; device += 2 * ms) clock.update(device, world.received(device));
    std::int64_t noticed = -1;
    for (std::int64_t later = 0; later < 2 * s && noticed < 0; later += 2 * ms) {
      const auto verdict = clock.update(device + later + step, world.received(device + later));
      if (verdict == DeviceClock::Update::jump) noticed = later;
    }
    EXPECT_EQ(noticed, 0) << "either way the stamps themselves give it away";
    EXPECT_NEAR(static_cast<double>(clock.mapping()->to_host(device + step) - world.sent(device)), 0, 100e6);
  }
}

TEST(DeviceClock, NoticesAClockSetBackDuringASilence) {
  World world;
  world.spikes = 0;
  DeviceClock clock;
  std::int64_t device = 100 * s;
  for (; device < 110 * s; device += 2 * ms) clock.update(device, world.received(device));
  // 3 s of silence, 1 s of which the device's clock lost: its time only ever grew.
  std::int64_t noticed = -1;
  for (std::int64_t later = 3 * s; later < 5 * s && noticed < 0; later += 2 * ms) {
    const auto verdict = clock.update(device + later - 1 * s, world.received(device + later));
    EXPECT_NE(verdict, DeviceClock::Update::regular);
    if (verdict == DeviceClock::Update::jump) noticed = later - 3 * s;
  }
  EXPECT_GE(noticed, 499 * ms);
  EXPECT_LE(noticed, 510 * ms);
}

TEST(DeviceClock, DoesNotTakeAStalledHostForAJump) {
  World world;
  world.spikes = 0;
  DeviceClock clock;
  const std::int64_t stall = 110 * s;
  for (std::int64_t device = 100 * s; device < 130 * s; device += 2 * ms) {
    // 300 ms of packets arrive together at the stall's end.
    const bool held = device >= stall && device < stall + 300 * ms;
    clock.update(device, held ? world.sent(stall + 300 * ms) : world.received(device));
  }
  EXPECT_EQ(clock.jumps(), 0u);
  EXPECT_NEAR(static_cast<double>(clock.mapping()->to_host(130 * s) - world.sent(130 * s)), 80'000, 60'000);
}

TEST(DeviceClock, SurvivesALongSilence) {
  World world;
  world.drift = 90e-6;
  DeviceClock clock;
  for (std::int64_t device = 100 * s; device < 110 * s; device += 2 * ms) {
    clock.update(device, world.received(device));
  }
  for (std::int64_t device = 4000 * s; device < 4010 * s; device += 2 * ms) {
    clock.update(device, world.received(device));
  }
  EXPECT_EQ(clock.jumps(), 0u) << "0.35 s in an hour is drift, not a jump";
  EXPECT_LT(std::abs(static_cast<double>(clock.mapping()->to_host(4010 * s) - world.sent(4010 * s))),
            4 * clock.mapping()->sigma_ns(4010 * s));
}

TEST(DeviceClock, TakesReorderedAndRepeatedPackets) {
  World world;
  world.spikes = 0;
  DeviceClock ordered, shuffled;
  std::vector<std::pair<std::int64_t, std::int64_t>> packets;
  for (std::int64_t device = 0; device < 30 * s; device += 2 * ms)
    packets.push_back({device, world.received(device)});
  for (const auto& [device, host] : packets) ordered.update(device, host);
  for (std::size_t i = 0; i + 4 <= packets.size(); i += 4) {
    for (const std::size_t k : {2u, 0u, 3u, 3u, 1u})
      shuffled.update(packets[i + k].first, packets[i + k].second);
  }
  EXPECT_EQ(shuffled.jumps(), 0u);
  EXPECT_NEAR(static_cast<double>(shuffled.mapping()->to_host(30 * s) - ordered.mapping()->to_host(30 * s)),
              0, 30'000);
}

TEST(DeviceClock, TakesAnyStampWithoutOverflow) {
  DeviceClock clock;
  std::mt19937_64 random(6);
  for (int i = 0; i < 10'000; ++i) {
    clock.update(static_cast<std::int64_t>(random()), static_cast<std::int64_t>(random()));
    const auto device = static_cast<std::int64_t>(random());
    EXPECT_GE(clock.mapping()->sigma_ns(device), 0);
    clock.mapping()->to_host(device);
  }
}

}  // namespace
}  // namespace ca2
