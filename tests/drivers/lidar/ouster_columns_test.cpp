// Pixels of every packet profile, and columns as returns: the loops for newer processors give what the
// portable ones do.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <random>
#include <vector>

#include "drivers/lidar/avx512.h"
#include "drivers/lidar/model.h"
#include "drivers/lidar/ouster/column_returns.h"
#include "drivers/lidar/ouster/profile.h"
#include "tests/drivers/lidar/written_returns.h"

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
#if defined(__x86_64__)
        if (__builtin_cpu_supports("avx2")) {
          Column avx2;
          profile.decode_avx2(bytes.data(), rows, avx2.pixels(all_fields));
          EXPECT_EQ(avx2, portable) << profile.name << ", " << rows << " rows";
        }
#endif
        EXPECT_NE(here, Column{}) << profile.name;
      }
    }
  }
}

#if defined(__x86_64__)
TEST(OusterColumns, EveryProcessorWritesTheSameReturns) {
  if (!has_avx512()) GTEST_SKIP() << "this processor has no AVX-512";
  std::mt19937_64 random(2);
  const OusterModel& model = *(*find_lidar_model("OS0-128"))->ouster();
  const OusterMetadata upright = nominal_ouster_metadata(model, 1024, 10, "RNG19_RFL8_SIG16_NIR16");
  OusterMetadata tilted = upright;
  const Eigen::AngleAxisd tilt(0.3, Eigen::Vector3d(1, 2, 3).normalized());
  tilted.lidar_to_sensor.topLeftCorner<3, 3>() = tilt.toRotationMatrix();
  for (const OusterMetadata& metadata : {upright, tilted}) {
    const OusterGeometry geometry = make_ouster_geometry(metadata);
    EXPECT_EQ(geometry.columns[5].upright, metadata.lidar_to_sensor(2, 2) == 1);
    for (const int rows : {1, 7, 8, 9, 16, 31, 64, 127, 128}) {
      for (const unsigned missing : {0u, 1u, 7u, 8u}) {  // of eight
        const std::size_t column = random() % 1024;
        // Exactly as long as the rows are: where more was read, a sanitizer says so.
        std::vector<std::uint32_t> ranges(static_cast<std::size_t>(rows));
        std::vector<std::uint8_t> intensity(ranges.size());
        std::vector<std::uint16_t> rings(ranges.size());
        for (std::size_t i = 0; i < ranges.size(); ++i) {
          ranges[i] = random() % 8 < missing ? 0 : static_cast<std::uint32_t>(1 + random() % 0xfffff);
          intensity[i] = static_cast<std::uint8_t>(random());
          rings[i] = static_cast<std::uint16_t>(random());
        }
        const FiredNames names{
            ranges.data(), intensity.data(), rings.data(), nullptr, 17, 1'700'000'000'123'456'789, rows};
        std::array<std::uint32_t, FiredBeams::most> padded{};
        std::copy(ranges.begin(), ranges.end(), padded.begin());
        FiredBeams beams;
        detail::project_ouster_column(geometry, column, padded.data(), rows, beams);
        WrittenReturns portable, sixteens;
        const std::size_t n = detail::write_returns_portable(beams, names, portable.targets(), 0);
        ASSERT_EQ(detail::write_ouster_column_avx512(geometry, column, names, sixteens.targets(), 0), n);
        EXPECT_TRUE(portable.same(sixteens, n)) << rows << " rows";
        EXPECT_EQ(n, ranges.size() - static_cast<std::size_t>(std::count(ranges.begin(), ranges.end(), 0u)));
      }
    }
  }
}
#endif

}  // namespace
}  // namespace ca2
