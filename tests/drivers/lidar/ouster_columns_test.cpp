// Pixels of every packet profile: the loops for newer processors read what the portable ones do.
#include <gtest/gtest.h>

#include <array>
#include <random>
#include <vector>

#include "drivers/lidar/ouster/profile.h"

namespace ca2 {
namespace {

struct Column {
  static constexpr std::size_t most = 144;
  std::array<std::uint32_t, most> range[2]{};
  std::array<std::uint8_t, most> reflectivity[2]{};
  std::array<std::uint16_t, most> signal[2]{}, near_ir{};

  bool operator==(const Column&) const = default;
  OusterPixels pixels(bool all_fields) {
    OusterPixels out;
    for (int i = 0; i < 2; ++i) {
      out.range[i] = range[i].data();
      out.reflectivity[i] = reflectivity[i].data();
      if (all_fields) out.signal[i] = signal[i].data();
    }
    if (all_fields) out.near_ir = near_ir.data();
    return out;
  }
};

TEST(OusterColumns, EveryProcessorReadsTheSame) {
  std::mt19937_64 random(1);
  for (const OusterProfile& profile : ouster_profiles()) {
    for (const int rows : {1, 7, 8, 9, 16, 31, 64, 127, 128}) {
      for (const bool all_fields : {false, true}) {
        // No byte more than a packet has after its last pixel.
        std::vector<std::uint8_t> bytes(static_cast<std::size_t>(rows * profile.pixel_bytes) + 3);
        for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
        Column portable, here;
        profile.decode_portable(bytes.data(), rows, portable.pixels(all_fields));
        profile.decode(bytes.data(), rows, here.pixels(all_fields));
        EXPECT_EQ(here, portable) << profile.name << ", " << rows << " rows";
        EXPECT_NE(here, Column{}) << profile.name;
      }
    }
  }
}

}  // namespace
}  // namespace ca2
