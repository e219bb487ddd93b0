/// @file Totals of counters that wrap around.
#pragma once

#include <cstdint>

namespace ca2 {

/// The total of a 32-bit counter that started at zero and wraps, from looks at it that are less than one
/// turn apart.
class WrappingCounter {
 public:
  /// Takes a look at the counter; what was added since the last one.
  std::uint32_t update(std::uint32_t value) {
    const std::uint32_t added = value - last_;  // modulo 2^32, which is right across the wrap
    last_ = value;
    total_ += added;
    return added;
  }

  std::uint64_t total() const { return total_; }

 private:
  std::uint32_t last_ = 0;
  std::uint64_t total_ = 0;
};

}  // namespace ca2
