#include "drivers/clock/hour_clock.h"

#include <gtest/gtest.h>

namespace ca2 {
namespace {

constexpr std::int64_t s = 1'000'000'000;
constexpr std::int64_t hour = nanoseconds_per_hour;
constexpr std::int64_t noon = 472'222 * hour;  // some top of an hour, UTC

std::uint32_t stamp(std::int64_t device) {
  return static_cast<std::uint32_t>(device % hour / 1000);
}

TEST(HourClock, RunsOnThroughTheHours) {
  HourClock clock;
  const std::int64_t start = 3590 * s;
  for (std::int64_t elapsed = 0; elapsed < 10 * hour; elapsed += 7 * s) {
    EXPECT_EQ(clock.unwrap(stamp(start + elapsed), noon + elapsed), start + elapsed);
  }
}

TEST(HourClock, TakesPacketsReorderedAcrossTheWrap) {
  HourClock clock;
  EXPECT_EQ(clock.unwrap(stamp(3599 * s), noon), 3599 * s);
  EXPECT_EQ(clock.unwrap(stamp(3601 * s), noon + 2 * s), 3601 * s);
  EXPECT_EQ(clock.unwrap(stamp(3599 * s + s / 2), noon + 2 * s), 3599 * s + s / 2);
}

TEST(HourClock, CountsTheHoursOfASilence) {
  HourClock clock;
  EXPECT_EQ(clock.unwrap(stamp(100 * s), noon), 100 * s);
  const std::int64_t silence = 5 * hour + 2000 * s;
  EXPECT_EQ(clock.unwrap(stamp(100 * s + silence), noon + silence + 3 * s), 100 * s + silence);
}

TEST(HourClock, RefusesWhatNoClockShows) {
  HourClock clock;
  EXPECT_FALSE(clock.unwrap(3'600'000'000u, noon));
  EXPECT_FALSE(clock.unwrap(0xffffffffu, noon));
  EXPECT_TRUE(clock.unwrap(3'599'999'999u, noon));
  EXPECT_FALSE(utc_from_hour(3'600'000'000u, noon));
}

TEST(HourClock, FindsTheHourOfALockedSensor) {
  EXPECT_EQ(utc_from_hour(stamp(noon + 10 * s), noon + 10 * s + 1), noon + 10 * s);
  EXPECT_EQ(utc_from_hour(stamp(hour - s), noon + s), noon - s) << "sent before the hour, received after it";
  EXPECT_EQ(utc_from_hour(stamp(s), noon - s), noon + s) << "a host clock that is behind";
}

}  // namespace
}  // namespace ca2
