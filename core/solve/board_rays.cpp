#include "core/solve/board_rays.h"

#include <cmath>

namespace ca2 {

std::vector<BoardReturn> returns_through_board(const LidarSight& sight, const Outline& outline,
                                               const Pose& T_lidar_board, double margin) {
  std::vector<BoardReturn> inside;
  const Eigen::Vector3d normal = T_lidar_board.R.col(2);
  const double distance = normal.dot(T_lidar_board.t);
  const double half_width = 0.5 * outline.width - margin;
  const double half_height = 0.5 * outline.height - margin;
  const auto take = [&](const std::vector<BoardReturn>& points) {
    for (const BoardReturn& candidate : points) {
      const Eigen::Vector3d ray = candidate.point.cast<double>();
      const double scale = distance / normal.dot(ray);  // the ray meets the plane at scale * ray
      if (!(scale > 0)) continue;
      const Eigen::Vector3d hit = scale * ray - T_lidar_board.t;
      if (std::abs(T_lidar_board.R.col(0).dot(hit) - outline.center.x()) <= half_width &&
          std::abs(T_lidar_board.R.col(1).dot(hit) - outline.center.y()) <= half_height) {
        inside.push_back(candidate);
      }
    }
  };
  take(sight.on_board);
  take(sight.around);
  return inside;
}

}  // namespace ca2
