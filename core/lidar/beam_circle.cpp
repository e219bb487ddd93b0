#include "core/lidar/beam_circle.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/types/hot_loop.h"

namespace ca2 {
namespace {

/// m: no LiDAR that spins is larger, and an OS0's circle is well within.
constexpr float most_radius = 0.10f, most_height = 0.10f;
/// Enough to fill 128 rings many times, and some times while looking far and wide.
constexpr std::size_t most_samples = 6000, most_far = 2000, least_samples = 500;
/// m: returns farther than this tell of heights, and nearer ones of little else, while a circle is searched
/// for in steps of `coarse`.
constexpr float far_enough = 1.5f;
constexpr float coarse = 0.004f;
/// rad, a third of what parts an OS1-128's rings: half a step moves far returns by one such bin.
constexpr float wide_bin = 0.002f, fine_bin = 0.0005f;

struct Sample {
  float rho, z;  // m
};

/// How much the elevations crowd: larger for fewer places.
class Crowding {
 public:
  float operator()(const std::vector<Sample>& samples, BeamCircle from, float bin) {
    place_.resize(samples.size());
    to_places(samples.data(), samples.size(), from, 1 / bin, place_.data());
    count_.assign(static_cast<std::size_t>(2 / bin) + 3, 0);
    for (const std::uint32_t place : place_) ++count_[place];
    float sum = 0;
    // Neighbours together: a ring may lie across two bins.
    for (std::size_t i = 0; i + 1 < count_.size(); ++i) {
      const auto both = static_cast<float>(count_[i] + count_[i + 1]);
      sum += both * both;
    }
    return sum;
  }

 private:
  /// What grows as the elevation does, at its pace near the horizon and half of it at 45 degrees.
  CA2_HOT_LOOP static void to_places(const Sample* __restrict samples, std::size_t size, BeamCircle from,
                                     float per_bin, std::uint32_t* __restrict out) {
    for (std::size_t i = 0; i < size; ++i) {
      const float rho = samples[i].rho - from.radius, z = samples[i].z - from.height;
      const float along = rho > 1e-3f ? rho : 1e-3f;
      out[i] = static_cast<std::uint32_t>((1 + z / (along + std::abs(z))) * per_bin);
    }
  }

  std::vector<std::uint32_t> place_, count_;
};

}  // namespace

std::optional<BeamCircle> find_beam_circle(std::span<const Eigen::Vector3f> points) {
  std::vector<Sample> all, far;
  // Steps that are no multiple of any number of rings.
  std::size_t step = 1;
  for (const std::size_t prime : {3, 7, 13, 29, 61, 127, 251}) {
    if (prime * most_samples <= points.size()) step = prime;
  }
  for (std::size_t i = 0; i < points.size(); i += step) {
    if (!is_return(points[i])) continue;
    all.push_back({points[i].head<2>().norm(), points[i].z()});
    if (all.back().rho > far_enough) far.push_back(all.back());
  }
  if (all.size() < least_samples) return std::nullopt;
  if (far.size() < least_samples) far = all;
  const std::size_t few = std::min(far.size(), most_far);
  for (std::size_t i = 0; i < few; ++i) far[i] = far[i * far.size() / few];
  far.resize(few);

  Crowding crowding;
  BeamCircle best;
  float most = -1;
  const auto look = [&](const std::vector<Sample>& samples, BeamCircle at, float bin) {
    const float crowd = crowding(samples, at, bin);
    if (crowd <= most) return;
    most = crowd;
    best = at;
  };
  for (float radius = 0; radius <= most_radius; radius += 2 * coarse) {
    for (float height = -most_height; height <= most_height; height += coarse)
      look(far, {radius, height}, wide_bin);
  }
  float bin = wide_bin;
  for (float reach = coarse; reach > 0.0002f; reach /= 2) {
    bin = std::max(bin / 1.5f, fine_bin);
    most = -1;
    const BeamCircle middle = best;
    for (int i = -2; i <= 2; ++i) {
      for (int k = -2; k <= 2; ++k) {
        look(all,
             {std::max(0.0f, middle.radius + static_cast<float>(i) * reach),
              middle.height + static_cast<float>(k) * reach},
             bin);
      }
    }
  }
  return best;
}

}  // namespace ca2
