// Returns into scans: what is left out, every body of the loop, whose memory is used.
#include "drivers/lidar/return_writer.h"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <thread>

#include "drivers/lidar/avx512.h"
#include "drivers/shared_pool.h"
#include "tests/drivers/lidar/written_returns.h"

namespace ca2 {
namespace {

/// Beams at random, with arrays as long as whole lanes.
struct Fired {
  FiredBeams beams{};
  std::array<std::uint32_t, FiredBeams::most> counts{};
  std::array<std::uint8_t, FiredBeams::most> intensity{};
  std::array<std::uint16_t, FiredBeams::most> ring{};
  std::array<std::int32_t, FiredBeams::most> delay{};
  int size;

  Fired(int beam_count, double missing, std::mt19937_64& random) : size(beam_count) {
    const auto number = [&] { return static_cast<float>(random() % 100000) * 1e-3f; };
    for (std::size_t i = 0; i < FiredBeams::most; ++i) {
      beams.x[i] = number(), beams.y[i] = number(), beams.z[i] = number();
      beams.range[i] = number();
      intensity[i] = static_cast<std::uint8_t>(random());
      const bool absent = static_cast<double>(random() % 1000) < 1000 * missing;
      counts[i] = absent ? 0 : static_cast<std::uint32_t>(1 + random() % 500000);
      ring[i] = static_cast<std::uint16_t>(random());
      delay[i] = static_cast<std::int32_t>(random() % 100000);
    }
  }
  FiredNames names(std::uint32_t column) const {
    return {counts.data(), intensity.data(),          ring.data(), delay.data(),
            column,        1'700'000'000'123'456'789, size};
  }
  /// All at once, and as if they were the beams of `beams` from the eighth on.
  FiredNames later_names(std::uint32_t column) const {
    FiredNames out = names(column);
    out.delay = nullptr;
    out.first = 8;
    return out;
  }
};

TEST(ReturnWriter, KeepsWhatIsAReturnInItsOrder) {
  std::mt19937_64 random(1);
  Scan scan;
  ReturnWriter writer;
  // The second round writes into what the first left, which was longer.
  for (const int columns : {40, 11}) {
    writer.begin(scan, 0);
    std::vector<Fired> fired;
    for (int column = 0; column < columns; ++column) {
      fired.emplace_back(1 + static_cast<int>(random() % 130), 0.3, random);
      writer.add(fired.back().beams, fired.back().names(static_cast<std::uint32_t>(column)));
    }
    writer.finish();
    std::size_t n = 0;
    for (int column = 0; column < columns; ++column) {
      const Fired& f = fired[static_cast<std::size_t>(column)];
      for (int i = 0; i < f.size; ++i) {
        const auto at = static_cast<std::size_t>(i);
        if (f.counts[at] == 0) continue;
        ASSERT_LT(n, scan.size());
        EXPECT_EQ(scan.points[n], Eigen::Vector3f(f.beams.x[i], f.beams.y[i], f.beams.z[i]));
        EXPECT_EQ(scan.range[n], f.beams.range[i]);
        EXPECT_EQ(scan.intensity[n], f.intensity[at]);
        EXPECT_EQ(scan.ring[n], f.ring[at]);
        EXPECT_EQ(scan.column[n], static_cast<std::uint32_t>(column));
        EXPECT_EQ(scan.time[n], 1'700'000'000'123'456'789 + f.delay[at]);
        ++n;
      }
    }
    EXPECT_EQ(scan.size(), n);
    EXPECT_EQ(scan.range.size(), n);
    EXPECT_EQ(scan.intensity.size(), n);
    EXPECT_EQ(scan.ring.size(), n);
    EXPECT_EQ(scan.column.size(), n);
    EXPECT_EQ(scan.time.size(), n);
  }
}

#if defined(__x86_64__)
TEST(ReturnWriter, EveryBodyWritesTheSame) {
  if (!__builtin_cpu_supports("avx2")) GTEST_SKIP() << "this processor has no AVX2";
  std::mt19937_64 random(2);
  for (int size = 1; size <= FiredBeams::most; size += size < 40 ? 1 : 59) {
    for (const double missing : {0.0, 0.1, 0.5, 0.9, 1.0}) {
      const Fired fired(size, missing, random);
      const FiredNames names =
          size > FiredBeams::most - 16 || size % 2 == 0 ? fired.names(7) : fired.later_names(7);
      WrittenReturns portable;
      const std::size_t n = detail::write_returns_portable(fired.beams, names, portable.targets(), 0);
      for (const auto write : {detail::write_returns_avx2, detail::write_returns_avx512}) {
        if (write == detail::write_returns_avx512 && !has_avx512()) continue;
        WrittenReturns vectors;
        ASSERT_EQ(write(fired.beams, names, vectors.targets(), 0), n);
        EXPECT_TRUE(portable.same(vectors, n)) << size << " beams";
      }
    }
  }
}
#endif

TEST(ReturnWriter, BeamsFromALaterOneOnAndFiredAtOnce) {
  std::mt19937_64 random(3);
  const Fired fired(16, 0.3, random);
  Scan scan;
  ReturnWriter writer;
  writer.begin(scan, 16);
  writer.add(fired.beams, fired.later_names(4));
  writer.finish();
  std::size_t n = 0;
  for (std::size_t i = 0; i < 16; ++i) {
    if (fired.counts[i] == 0) continue;
    ASSERT_LT(n, scan.size());
    EXPECT_EQ(scan.range[n], fired.beams.range[8 + i]);
    EXPECT_EQ(scan.points[n].z(), fired.beams.z[8 + i]);
    EXPECT_EQ(scan.ring[n], fired.ring[i]);
    EXPECT_EQ(scan.time[n], 1'700'000'000'123'456'789);
    ++n;
  }
  EXPECT_EQ(scan.size(), n);
}

TEST(SharedPool, MemoryComesBackFromAnyThreadAndAfterThePool) {
  auto pool = std::make_unique<SharedPool<Scan>>();
  Scan scan;
  scan.points.assign(1000, Eigen::Vector3f(1, 2, 3));
  const Eigen::Vector3f* const memory = scan.points.data();
  std::shared_ptr<const Scan> kept = pool->keep(scan);
  EXPECT_EQ(kept->points.data(), memory);
  EXPECT_TRUE(scan.points.empty());

  std::thread([&] { kept.reset(); }).join();
  scan.points.assign(10, Eigen::Vector3f(4, 5, 6));
  kept = pool->keep(scan);
  EXPECT_EQ(kept->size(), 10u);
  EXPECT_EQ(scan.points.data(), memory) << "what was let go of is written again";
  pool.reset();
  EXPECT_EQ(kept->points[9].x(), 4);
}

}  // namespace
}  // namespace ca2
