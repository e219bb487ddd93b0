/// @file Returns into the arrays of a scan, missing ones left out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>

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

/// The arrays of a scan.
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
    add_by(names.beams,
           [&](const detail::ReturnTargets& out, std::size_t at) { return write_(beams, names, out, at); });
  }
  /// The same of so many beams by other means: write(targets, at) writes from that place on, as
  /// detail::write_returns_portable() does.
  template <class OtherWrite>
  void add_by(int beams, const OtherWrite& write) {
    const std::size_t needed = size_ + static_cast<std::size_t>(beams) + spare;
    if (needed > room_) grow(needed);
    size_ = write(std::as_const(targets_), size_);
  }
  /// Cuts the arrays to what was written.
  void finish();

  std::size_t size() const { return size_; }

 private:
  using Write = std::size_t(const FiredBeams&, const FiredNames&, const detail::ReturnTargets&, std::size_t);
  static constexpr std::size_t spare = 16;  // written beyond the last return
  static Write* fastest();                  ///< what suits this processor
  void resize(std::size_t returns);
  void grow(std::size_t needed);
  void find_targets();

  Write* write_;
  Scan* scan_ = nullptr;
  detail::ReturnTargets targets_{};  ///< scan_'s
  std::size_t expected_ = 0;
  std::size_t room_ = 0;    ///< what the smallest of the arrays holds
  std::size_t memory_ = 0;  ///< what they could hold without moving
  std::size_t size_ = 0;
};

namespace detail {

/// Writes returns from place `at` on, and says where the next ones go. Up to sixteen beyond may be
/// overwritten.
std::size_t write_returns_portable(const FiredBeams& beams, const FiredNames& names, const ReturnTargets& out,
                                   std::size_t at);
#if defined(__x86_64__)
/// The same numbers; only where the processor has AVX2.
std::size_t write_returns_avx2(const FiredBeams& beams, const FiredNames& names, const ReturnTargets& out,
                               std::size_t at);
/// Where has_avx512().
std::size_t write_returns_avx512(const FiredBeams& beams, const FiredNames& names, const ReturnTargets& out,
                                 std::size_t at);
#endif

}  // namespace detail
}  // namespace ca2
