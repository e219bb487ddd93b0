#include "core/solve/ink_evidence.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

namespace ca2 {
namespace {

/// Divergence of a beam as the ink sees it, rad.
constexpr double beam_width = 0.004;
/// Nearer to the rim than this, m and rad, a beam sees past the plate.
constexpr double margin = 0.006, margin_angle = 0.003;
/// Fewer tell nothing of a ring's gain, or of anything.
constexpr std::size_t least_of_ring = 8, least_returns = 40;
/// Glare and tape: no return counts as more than this many times its ring's median.
constexpr double brightest = 3;
/// The model of a spot on squares is no better than this, as a share of the intensities' variance.
constexpr double model_error = 0.02;

/// A return on the plate.
struct Spot {
  double along;       ///< rad, along its ring
  double value;       ///< intensity
  Eigen::Vector3d x;  ///< ink, and its place on the plate
};
using Rings = std::map<int, std::vector<Spot>>;

Rings spots_on(const LidarSight& sight, const InkMap& ink, const Outline& outline,
               const Pose& T_lidar_board) {
  Rings rings;
  const Pose T_board_lidar = T_lidar_board.inverse();
  const double azimuth = std::atan2(T_lidar_board.t.y(), T_lidar_board.t.x());
  const double gate = std::max(0.02, 5 * sight.rms);
  for (const auto* returns : {&sight.on_board, &sight.around}) {
    for (const BoardReturn& here : *returns) {
      if (here.intensity == BoardReturn::no_intensity) continue;
      const Eigen::Vector3d p = T_board_lidar * here.point.cast<double>();
      const double range = here.point.norm(), inset = margin + margin_angle * range;
      const Eigen::Vector2d from_centre = (p.head<2>() - outline.center).cwiseAbs();
      if (std::abs(p.z()) > gate || from_centre.x() > 0.5 * outline.width - inset ||
          from_centre.y() > 0.5 * outline.height - inset) {
        continue;
      }
      const double angle = std::atan2(here.point.y(), here.point.x());
      rings[here.ring].push_back({std::remainder(angle - azimuth, 2 * M_PI),
                                  static_cast<double>(here.intensity),
                                  {ink.share(p.head<2>(), beam_width * range), p.x(), p.y()}});
    }
  }
  std::erase_if(rings, [](const auto& entry) { return entry.second.size() < least_of_ring; });
  return rings;
}

/// Gains and means of the rings taken out. A ring that sends nothing back is left with nothing.
void centre(std::vector<Spot>& ring) {
  std::vector<double> values;
  for (const Spot& spot : ring) values.push_back(spot.value);
  const auto half = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), half, values.end());
  const double median = *half;
  double mean = 0;
  Eigen::Vector3d x = Eigen::Vector3d::Zero();
  for (Spot& spot : ring) {
    spot.value = median > 0 ? std::min(spot.value / median, brightest) : 0;
    mean += spot.value / static_cast<double>(ring.size());
    x += spot.x / static_cast<double>(ring.size());
  }
  for (Spot& spot : ring) {
    spot.value -= mean;
    spot.x -= x;
  }
}

/// How many returns speak as one: 1 + 2 (sum of the residuals' correlations along the rings).
double spoken_together(const Rings& rings, const Eigen::Vector3d& slopes) {
  constexpr std::size_t furthest = 200;
  constexpr double uncorrelated = 0.05;
  double together = 1;
  for (std::size_t lag = 1; lag <= furthest; ++lag) {
    double products = 0, squares = 0;
    for (const auto& [number, ring] : rings) {
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const double e = ring[i].value - slopes.dot(ring[i].x);
        squares += e * e;
        if (i >= lag) products += e * (ring[i - lag].value - slopes.dot(ring[i - lag].x));
      }
    }
    if (!(products > uncorrelated * squares)) break;
    together += 2 * products / squares;
  }
  return together;
}

}  // namespace

double ink_log_odds(const LidarSight& sight, const InkMap& ink, const Outline& outline,
                    const Pose& T_lidar_board) {
  Rings rings = spots_on(sight, ink, outline, T_lidar_board);
  double count = 0, yy = 0;
  Eigen::Matrix3d xx = Eigen::Matrix3d::Zero();
  Eigen::Vector3d xy = Eigen::Vector3d::Zero();
  for (auto& [number, ring] : rings) {
    centre(ring);
    std::sort(ring.begin(), ring.end(), [](const Spot& a, const Spot& b) { return a.along < b.along; });
    count += static_cast<double>(ring.size());
    for (const Spot& spot : ring) {
      yy += spot.value * spot.value;
      xx += spot.x * spot.x.transpose();
      xy += spot.x * spot.value;
    }
  }
  if (count < least_returns || !(yy > 0)) return 0;
  const Eigen::Vector2d even = xx.bottomRightCorner<2, 2>().ldlt().solve(xy.tail<2>());
  const Eigen::Vector3d slopes = xx.ldlt().solve(xy);
  if (!even.allFinite() || !slopes.allFinite() || !(slopes(0) < 0)) return 0;
  const double without = yy - even.dot(xy.tail<2>());
  const double with = std::max(yy - slopes.dot(xy), model_error * without);
  if (!(without > with)) return 0;
  return 0.5 * count / spoken_together(rings, slopes) * std::log(without / with);
}

}  // namespace ca2
