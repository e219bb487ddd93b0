/// @file How a T265 exposes, as its user sets it.
#pragma once

#include <cstdint>

namespace ca2::t265 {

inline constexpr double least_exposure = 200, most_exposure = 16000;  // us
inline constexpr double most_gain = 20;                               // dB, a factor of 10; the least is 0

/// Both imagers alike.
struct Exposure {
  bool automatic = true;
  double time = 5000;  ///< us, when not automatic
  double gain = 0;     ///< dB, when not automatic
};

}  // namespace ca2::t265
