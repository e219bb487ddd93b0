#include "core/lidar/beam_lens.h"

#include <algorithm>
#include <array>
#include <utility>

namespace ca2 {
namespace {

/// From the manual's table: offset over the tangent of the elevation, the same for all beams to 0.1 mm.
constexpr std::array<std::pair<std::string_view, double>, 1> radii{{{"VLP-16", 0.0418}}};

}  // namespace

double beam_lens_radius(std::string_view model) {
  const auto* known =
      std::find_if(radii.begin(), radii.end(), [&](const auto& entry) { return entry.first == model; });
  return known == radii.end() ? 0 : known->second;
}

}  // namespace ca2
