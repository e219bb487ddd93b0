#include "drivers/lidar/velodyne/packet_pace.h"

#include <gtest/gtest.h>

namespace ca2 {
namespace {

constexpr double vlp16 = 24 * 55.296e-6, hdl32e = 12 * 46.08e-6;  // s

/// Packets `apart` s from each other, every `lost`-th of which is not there.
bool is_other(double period, double apart, int lost = 1000) {
  VelodynePacketPace pace;
  bool other = false;
  for (int i = 0; i < 40; ++i) {
    const auto stamp = static_cast<std::uint32_t>(1e6 * apart * i);
    if (i % lost != lost - 1) other = pace.other_model(stamp, period);
  }
  return other;
}

TEST(PacketPace, TellsTheModelsThatShareANumberApart) {
  EXPECT_TRUE(is_other(vlp16, hdl32e));
  EXPECT_TRUE(is_other(hdl32e, vlp16));
}

TEST(PacketPace, SaysNothingOfAnyOtherPace) {
  for (const double period : {vlp16, hdl32e}) {
    for (const double apart : {1.0, 0.75, 1.25, 1.5, 2.0, 0.0}) {
      EXPECT_FALSE(is_other(period, apart * period)) << apart;
      EXPECT_FALSE(is_other(period, apart * period, 3)) << apart;
    }
  }
}

}  // namespace
}  // namespace ca2
