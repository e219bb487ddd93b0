#include "core/guidance/candidate_poses.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace ca2 {
namespace {

constexpr double tilt = 35 * M_PI / 180;
constexpr int tilts = 8;
constexpr double rim = 0.05;  // of the picture's width: nobody holds a board just where he is told to
constexpr double smallest_square = 12;  // px
constexpr double farthest_by_hand = 6;  // m
constexpr int distances = 7;
constexpr int columns = 5, rows = 3;

/// The camera's x right and y down stay the board's, as near as facing along `bearing` allows.
Eigen::Matrix3d facing(const Eigen::Vector3d& bearing) {
  return Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), bearing).toRotationMatrix();
}

bool whole(const Board& board, const Camera& camera, const Pose& T_camera_board) {
  for (const Eigen::Vector2d& p : board.type->corners(board)) {
    const auto pixel = camera.project(T_camera_board * Eigen::Vector3d(p.x(), p.y(), 0));
    if (!pixel || !camera.contains(*pixel, rim * camera.width)) return false;
  }
  return true;
}

}  // namespace

std::vector<Pose> candidate_poses(const Board& board, const Camera& camera) {
  const Outline extent = board.extent();
  const double nearest = 1.2 * std::max(extent.width, extent.height);
  const double farthest =
      std::clamp(camera.parameters[0] * board.square / smallest_square, 1.2 * nearest, farthest_by_hand);
  std::vector<Pose> poses;
  for (int d = 0; d < distances; ++d) {
    const double distance = nearest * std::pow(farthest / nearest, d / (distances - 1.0));
    for (int k = 0; k < columns * rows; ++k) {
      const Eigen::Vector2d pixel((k % columns + 0.5) / columns * camera.width,
                                  (k / columns + 0.5) / rows * camera.height);
      const auto bearing = camera.unproject(pixel);
      if (!bearing) continue;
      for (int side = -1; side < tilts; ++side) {
        const double axis = 2 * M_PI * side / tilts;
        const Eigen::Vector3d turn = side < 0
                                         ? Eigen::Vector3d(0, 0, 0)
                                         : Eigen::Vector3d(tilt * std::cos(axis), tilt * std::sin(axis), 0);
        const Pose pose{facing(*bearing) * so3_exp(turn), distance * *bearing};
        if (whole(board, camera, pose)) poses.push_back(pose);
      }
    }
  }
  return poses;
}

}  // namespace ca2
