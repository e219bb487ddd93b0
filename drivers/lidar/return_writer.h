/// @file Returns into the arrays of a scan, missing ones left out.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/types/scan.h"

namespace ca2 {

/// Beams that were fired together (a column, a block), with or without a return.
struct FiredBeams {
  static constexpr int most = 512;
  alignas(32) float x[most], y[most], z[most];  ///< m
  alignas(32) float range[most];                ///< m
};

/// What else is known of their returns.
struct FiredNames {
  const std::uint32_t* counts;  ///< by beam, 0: no return
  const std::uint8_t* intensity;
  const std::uint16_t* ring;  ///< by beam
  const std::int32_t* delay;  ///< ns after `time`, by beam, not negative; nullptr: 0
  std::uint32_t column;
  std::int64_t time;  ///< ns
  int beams;          ///< all arrays are readable up to the next multiple of eight
  int first = 0;      ///< of FiredBeams, whose arrays alone begin before what is named here; times eight
};

namespace detail {

/// Where the next returns go. Up to sixteen beyond what they return may be overwritten.
struct ReturnTargets {
  float* points;
  float* range;
  float* intensity;
  std::uint16_t* ring;
  std::uint32_t* column;
  std::int64_t* time;
};

}  // namespace detail

/// Arrays are written where they are and cut to size at the end: their memory is neither cleared nor copied,
/// and the system is not asked for it again.
class ReturnWriter {
 public:
  ReturnWriter();
  /// Starts over in this scan, which stays where it is; what was in it is lost. `expected`: returns.
  void begin(Scan& scan, std::size_t expected);
  void add(const FiredBeams& beams, const FiredNames& names) {
    wrote(write_(beams, names, room_for(names.beams)));
  }
  /// Where the returns of so many beams may be written by others; wrote() says how many they were.
  detail::ReturnTargets room_for(int beams) {
    const std::size_t needed = size_ + static_cast<std::size_t>(beams) + spare;
    if (needed > room_) grow(needed);
    return {scan_->points.data()->data() + 3 * size_,
            scan_->range.data() + size_,
            scan_->intensity.data() + size_,
            scan_->ring.data() + size_,
            scan_->column.data() + size_,
            scan_->time.data() + size_};
  }
  void wrote(std::size_t returns) { size_ += returns; }
  /// Cuts the arrays to what was written.
  void finish();

  std::size_t size() const { return size_; }

 private:
  using Write = std::size_t(const FiredBeams&, const FiredNames&, const detail::ReturnTargets&);
  static constexpr std::size_t spare = 16;  // written beyond the last return
  static Write* fastest();                  ///< what suits this processor
  void resize(std::size_t returns);
  void grow(std::size_t needed);

  Write* write_;
  Scan* scan_ = nullptr;
  std::size_t expected_ = 0;
  std::size_t room_ = 0;    ///< what the smallest of the arrays holds
  std::size_t memory_ = 0;  ///< what they could hold without moving
  std::size_t size_ = 0;
};

namespace detail {

/// The number of returns.
std::size_t write_returns_portable(const FiredBeams& beams, const FiredNames& names,
                                   const ReturnTargets& out);
#if defined(__x86_64__)
/// The same numbers; only where the processor has AVX2.
std::size_t write_returns_avx2(const FiredBeams& beams, const FiredNames& names, const ReturnTargets& out);
/// Where has_avx512().
std::size_t write_returns_avx512(const FiredBeams& beams, const FiredNames& names, const ReturnTargets& out);
#endif

}  // namespace detail
}  // namespace ca2
