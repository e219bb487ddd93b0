/// Host times of a device whose clock is read over a connection that takes its time.
#include "drivers/camera/t265/device_time.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace ca2::t265 {
namespace {

constexpr std::int64_t ms = 1'000'000, s = 1'000'000'000;

struct Connection {
  double drift;                    ///< host per device, minus 1
  double least_there, least_back;  ///< ns each way
  double jitter;                   ///< ns, mean of an exponential each way
  std::int64_t offset = 1'700'000'000 * s;

  std::int64_t host(std::uint64_t device) const {
    const double d = static_cast<double>(device);
    return offset + static_cast<std::int64_t>(device) + std::llround(d * drift);
  }
};

class Connections : public testing::TestWithParam<Connection> {};

TEST_P(Connections, StampsAreWithinTheirSigma) {
  const Connection& c = GetParam();
  std::mt19937_64 random(7);
  std::exponential_distribution<double> late(1 / c.jitter);
  DeviceTime time;
  EXPECT_FALSE(time.at(0));
  double worst = 0, squares = 0;
  int count = 0;
  for (std::uint64_t device = 3 * s; device < 63 * s; device += 500 * ms) {
    const auto there = std::llround(c.least_there + late(random)),
               back = std::llround(c.least_back + late(random));
    time.add(device, c.host(device) - there, c.host(device) + back);
    // A picture between this reading and the next.
    const std::uint64_t picture = device + 250 * ms;
    const auto stamp = time.at(picture);
    ASSERT_TRUE(stamp);
    const double error = static_cast<double>(stamp->time - c.host(picture));
    const double ratio = error / static_cast<double>(stamp->sigma);
    worst = std::max(worst, std::abs(error));
    squares += ratio * ratio;
    ++count;
  }
  EXPECT_LT(std::sqrt(squares / count), 1.5);
  EXPECT_LT(worst, 2e6);
  // Settled, it is as good as the way there and back allows, and half of the jitter of the readings.
  const auto last = time.at(62 * s);
  EXPECT_LT(std::abs(last->time - c.host(62 * s)), (c.least_there + c.least_back) / 2 + c.jitter / 2 + 20e3);
  EXPECT_LT(last->sigma, 1'000'000);
}

INSTANTIATE_TEST_SUITE_P(T265, Connections,
                         testing::Values(Connection{0, 100e3, 100e3, 50e3},
                                         Connection{40e-6, 100e3, 300e3, 200e3},
                                         Connection{-80e-6, 400e3, 50e3, 400e3}));

TEST(T265Time, ARestartedDeviceIsNoticed) {
  DeviceTime time;
  for (int i = 0; i < 10; ++i)
    time.add(100 * s + i * s, 1000 * s + i * s - 100'000, 1000 * s + i * s + 100'000);
  EXPECT_NEAR(static_cast<double>(time.at(105 * s)->time - 1005 * s), 0, 1e6);
  time.add(1 * s, 1020 * s - 100'000, 1020 * s + 100'000);
  EXPECT_NEAR(static_cast<double>(time.at(2 * s)->time - 1021 * s), 0, 1e6);
}

}  // namespace
}  // namespace ca2::t265
