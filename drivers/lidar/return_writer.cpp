#include "drivers/lidar/return_writer.h"

#include <algorithm>
#include <array>

#include "drivers/lidar/avx512.h"

namespace ca2 {
namespace detail {

/// Every beam is written and counted if it is a return: cheaper than a branch taken at random.
std::size_t write_returns_portable(const FiredBeams& beams, const FiredNames& names, const ReturnTargets& out,
                                   std::size_t at) {
  std::size_t n = at;
  for (int i = 0; i < names.beams; ++i) {
    const int beam = names.first + i;
    out.points[3 * n] = beams.x[beam];
    out.points[3 * n + 1] = beams.y[beam];
    out.points[3 * n + 2] = beams.z[beam];
    out.range[n] = beams.range[beam];
    out.intensity[n] = names.intensity[i];
    out.ring[n] = names.ring[i];
    out.column[n] = names.column;
    out.time[n] = names.time + (names.delay ? names.delay[i] : 0);
    n += names.counts[i] != 0;
  }
  return n;
}

}  // namespace detail

namespace {

constexpr std::size_t step = 1024;  // returns for which room is made at a time

/// What `f` says of each of the arrays.
template <class F>
auto of_arrays(Scan& scan, F f) {
  return std::array{f(scan.points), f(scan.intensity), f(scan.range),
                    f(scan.ring),   f(scan.column),    f(scan.time)};
}

}  // namespace

ReturnWriter::Write* ReturnWriter::fastest() {
#if defined(__x86_64__)
  if (has_avx512()) return detail::write_returns_avx512;
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("popcnt")) return detail::write_returns_avx2;
#endif
  return detail::write_returns_portable;
}

ReturnWriter::ReturnWriter() : write_(fastest()) {}

void ReturnWriter::begin(Scan& scan, std::size_t expected) {
  scan_ = &scan;
  expected_ = expected;
  size_ = 0;
  const auto least = [](const auto& sizes) { return *std::min_element(sizes.begin(), sizes.end()); };
  room_ = least(of_arrays(scan, [](const auto& array) { return array.size(); }));
  memory_ = least(of_arrays(scan, [](const auto& array) { return array.capacity(); }));
  find_targets();
}

void ReturnWriter::resize(std::size_t returns) {
  of_arrays(*scan_, [&](auto& array) { return array.resize(returns), 0; });
  room_ = returns;
  find_targets();
}

void ReturnWriter::find_targets() {
  // Of no points, there is no first one.
  float* const points = scan_->points.empty() ? nullptr : scan_->points.front().data();
  targets_ = {points,
              scan_->range.data(),
              scan_->intensity.data(),
              scan_->ring.data(),
              scan_->column.data(),
              scan_->time.data()};
}

/// A vector clears what it grows by: a little at a time, which is then in the cache when it is written.
void ReturnWriter::grow(std::size_t needed) {
  if (needed > memory_) {
    // Not more than expected, lest the arrays move: their memory is what takes time.
    memory_ = needed <= expected_ + spare ? expected_ + spare : needed + needed / 4;
    of_arrays(*scan_, [&](auto& array) { return array.reserve(memory_), 0; });
  }
  resize(std::min(needed + step, memory_));
}

void ReturnWriter::finish() {
  resize(size_);
}

}  // namespace ca2
