#include "core/solve/outline_centers.h"

#include <algorithm>
#include <cmath>

namespace ca2 {

std::optional<Eigen::Vector3d> center_error(const LidarSight& sight, const Pose& T_lidar_board,
                                            const Eigen::Vector2d& plate_center) {
  if (!sight.outline_center) return std::nullopt;
  const Eigen::Vector3d expected = T_lidar_board * Eigen::Vector3d(plate_center.x(), plate_center.y(), 0);
  const Eigen::Vector3d error = *sight.outline_center - expected;
  const Eigen::Vector3d normal = T_lidar_board.R.col(2);
  return Eigen::Vector3d(error - normal * normal.dot(error));
}

double center_sigma(std::vector<double> lengths) {
  std::sort(lengths.begin(), lengths.end());
  const double count = static_cast<double>(lengths.size());
  // Median of a Rayleigh distribution: 1.177 sigma. The answer follows the centres in 3 of their 2 n
  // coordinates.
  return std::max(0.002, lengths[lengths.size() / 2] / 1.177 * std::sqrt(2 * count / (2 * count - 3)));
}

CenterSight observe_center(const Eigen::Vector3d& error, const Pose& T_lidar_board,
                           const Eigen::Vector2d& plate_center, double sigma) {
  const Eigen::Vector3d normal = T_lidar_board.R.col(2);
  const double weight = std::min(1.0, 2 * sigma / std::max(1e-9, error.norm()));
  return {T_lidar_board * Eigen::Vector3d(plate_center.x(), plate_center.y(), 0) + error,
          weight / (sigma * sigma) * (Eigen::Matrix3d::Identity() - normal * normal.transpose())};
}

}  // namespace ca2
