#include "drivers/net/wrapping_counter.h"

#include <gtest/gtest.h>

#include <random>

#include "drivers/net/pacer.h"

namespace ca2 {
namespace {

TEST(WrappingCounter, IsExactAcrossTheWrap) {
  WrappingCounter counter;
  EXPECT_EQ(counter.update(0xffffffffu), 0xffffffffu);
  EXPECT_EQ(counter.update(0), 1u);
  EXPECT_EQ(counter.update(5), 5u);
  EXPECT_EQ(counter.total(), 0x100000005u);
}

TEST(WrappingCounter, FollowsAWideCounterThroughManyWraps) {
  std::mt19937_64 random(3);
  WrappingCounter counter;
  std::uint64_t truth = 0;
  for (int i = 0; i < 1000; ++i) {
    truth += random() % 0xffffffffu;
    counter.update(static_cast<std::uint32_t>(truth));
    ASSERT_EQ(counter.total(), truth);
  }
}

TEST(Pacer, KeepsTheRecordingsTimeAtAnySpeed) {
  for (const double speed : {0.5, 1.0, 4.0}) {
    Pacer pacer(speed);
    EXPECT_EQ(pacer.wait(1'000'000'000'000, 77), 0) << "the first is due at once";
    EXPECT_EQ(pacer.wait(1'000'000'100'000, 77), static_cast<std::int64_t>(100'000 / speed));
    EXPECT_EQ(pacer.wait(1'000'000'100'000, 77 + 50'000),
              std::max<std::int64_t>(0, static_cast<std::int64_t>(100'000 / speed) - 50'000));
  }
}

TEST(Pacer, DoesNotDelayLaterOnesForALateOne) {
  Pacer pacer(1);
  EXPECT_EQ(pacer.wait(0, 0), 0);
  EXPECT_EQ(pacer.wait(100, 5000), 0) << "late";
  EXPECT_EQ(pacer.wait(6000, 5000), 1000) << "on the schedule again";
  EXPECT_EQ(pacer.wait(-50, 5000), 0) << "stepping back";
}

TEST(Pacer, NeverWaitsAtFullSpeedOrOverflows) {
  Pacer fast(0);
  EXPECT_EQ(fast.wait(0, 0), 0);
  EXPECT_EQ(fast.wait(1'000'000'000'000, 0), 0);
  Pacer slow(1e-9);
  EXPECT_EQ(slow.wait(INT64_MIN, 0), 0);
  EXPECT_GT(slow.wait(INT64_MAX, 0), 0);
}

}  // namespace
}  // namespace ca2
