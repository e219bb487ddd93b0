/// @file Frames lost between two, from the numbers that the camera gives them.
#pragma once

#include <cstdint>
#include <optional>

namespace ca2 {

/// GigE Vision counts blocks in 16 bits and leaves out 0 (65535 is followed by 1), or in 64 bits.
class FrameCount {
 public:
  /// How many are missing before the frame of this number. A number that went back (the camera began anew) or
  /// that jumped too far, either way, counts as nothing missing.
  std::uint64_t missing_before(std::uint64_t id) {
    constexpr std::uint64_t last16 = 65535, most_lost = 10'000;
    const auto before = last_;
    last_ = id;
    if (!before || id == *before) return 0;
    if (id > *before) return id - *before <= most_lost ? id - *before - 1 : 0;
    const bool wrapped = *before <= last16 && id > 0 && last16 - *before + id <= most_lost;
    return wrapped ? last16 - *before + id - 1 : 0;
  }

 private:
  std::optional<std::uint64_t> last_;
};

}  // namespace ca2
