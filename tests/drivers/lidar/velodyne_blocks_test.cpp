// Blocks as returns: what AVX-512 reads, projects and writes in one step is what the portable steps give.
#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <random>
#include <vector>

#include "drivers/lidar/avx512.h"
#include "drivers/lidar/velodyne/block_returns.h"
#include "tests/drivers/lidar/written_returns.h"

namespace ca2 {
namespace {

#if defined(__x86_64__)
constexpr std::size_t channels = VelodynePacket::channels;

TEST(VelodyneBlocks, EveryProcessorWritesTheSameReturns) {
  if (!has_avx512()) GTEST_SKIP() << "this processor has no AVX-512";
  std::mt19937_64 random(1);
  const auto fill = [&](VelodyneProjection::Lanes& lanes) {
    for (float& lane : lanes) lane = static_cast<float>(random() % 2000001) * 1e-6f - 1;
  };
  for (int trial = 0; trial < 200; ++trial) {
    VelodyneProjection::Bank bank;
    VelodyneProjection::Turned turned;
    for (auto* lanes : {&bank.cos_vertical, &bank.sin_vertical, &bank.distance, &bank.vertical_offset,
                        &bank.horizontal_offset, &turned.sine, &turned.cosine}) {
      fill(*lanes);
    }
    const detail::VelodyneBlockPlace place{0.6f, -0.8f, turned, bank, 0.002f, trial % 2 == 1};
    // No byte more than there is after a packet's last block.
    std::vector<std::uint8_t> bytes(VelodynePacket::block_bytes + 4);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    std::array<std::uint16_t, channels> rings;
    std::array<std::int32_t, channels> delays;
    VelodyneProjection::Block block;
    for (std::size_t i = 0; i < channels; ++i) {
      const int channel = static_cast<int>(i);
      if (random() % 3 == 0) std::memset(&bytes[4 + 3 * i], 0, 2);  // no return
      block.counts[i] = VelodynePacket::distance(bytes.data(), channel);
      block.intensity[i] = VelodynePacket::intensity(bytes.data(), channel);
      rings[i] = static_cast<std::uint16_t>(random());
      delays[i] = static_cast<std::int32_t>(random() % 100000);
    }
    const bool halves = trial % 4 < 2;  // a VLP-16's two firings, or one of 32 lasers
    const int beams = halves ? 16 : 32;
    for (int first = 0; first < static_cast<int>(channels); first += beams) {
      const auto at = static_cast<std::size_t>(first);
      FiredNames names{&block.counts[at],
                       &block.intensity[at],
                       rings.data(),
                       delays.data(),
                       7,
                       1'700'000'000'123'456'789,
                       beams,
                       first};
      FiredBeams fired;
      detail::project_velodyne_block(block, place, static_cast<int>(channels), fired);
      WrittenReturns portable, sixteens;
      const std::size_t n = detail::write_returns_portable(fired, names, portable.targets(), 0);
      names.counts = nullptr;
      names.intensity = nullptr;
      ASSERT_EQ(detail::write_velodyne_block_avx512(bytes.data(), place, names, sixteens.targets(), 0), n);
      EXPECT_GT(n, 0u);
      EXPECT_TRUE(portable.same(sixteens, n)) << beams << " beams from " << first;
    }
  }
}
#endif

}  // namespace
}  // namespace ca2
