/// @file Boards, cameras and poses that the board tests share.
#pragma once

#include <random>

#include "core/board/board.h"
#include "core/geometry/so3.h"

namespace ca2::test {

inline Board make_board(std::string_view type, int columns, int rows, double square = 0.04) {
  Board board;
  board.type = find_board_type(type);
  board.columns = columns;
  board.rows = rows;
  board.square = square;
  board.marker = 0.75 * square;
  return board;
}

inline Camera make_camera(const char* model, std::initializer_list<double> parameters, int width,
                          int height) {
  Camera camera;
  camera.model = find_camera_model(model);
  camera.parameters.resize(static_cast<Eigen::Index>(parameters.size()));
  std::copy(parameters.begin(), parameters.end(), camera.parameters.data());
  camera.width = width;
  camera.height = height;
  return camera;
}

/// A narrow industrial camera of 1388 x 1038.
inline Camera narrow_camera() {
  return make_camera("pinhole_radtan", {1250, 1252, 694, 519, -0.1, 0.05, 1e-3, -5e-4, 0.01}, 1388, 1038);
}

/// A tracking camera's fisheye, 163 degrees across 848 x 800.
inline Camera fisheye_camera() {
  return make_camera("kannala_brandt", {286, 286, 424, 400, -0.007, 0.044, -0.042, 0.007}, 848, 800);
}

/// A 2048 x 1536 camera with a moderate lens.
inline Camera large_camera() {
  return make_camera("pinhole_radtan", {1700, 1700, 1024, 768, -0.2, 0.1, 0, 0, 0}, 2048, 1536);
}

/// A board at `distance` [m] in direction `bearing`, tilted by `tilt` [rad] about an axis in its plane, then
/// rolled.
inline Pose board_pose(const Eigen::Vector3d& bearing, double distance, double tilt, double tilt_axis,
                       double roll) {
  const Eigen::Matrix3d R_facing =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), bearing).toRotationMatrix();
  const Eigen::Vector3d axis(std::cos(tilt_axis), std::sin(tilt_axis), 0);
  return {R_facing * so3_exp(tilt * axis) * so3_exp(Eigen::Vector3d(0, 0, roll)),
          bearing.normalized() * distance};
}

}  // namespace ca2::test
