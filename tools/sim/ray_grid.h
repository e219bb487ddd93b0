/// @file The directions of a camera's pixels, from a coarse grid: a projection model's inverse is iterative
/// and would cost more than everything else in a rendered picture.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/camera/camera_model.h"

namespace ca2 {

/// Unit directions every 2 px, interpolated by bicubic polynomials: exact to 1e-4 px even at the rim of a
/// 163-degree fisheye (a test measures it).
class RayGrid {
 public:
  explicit RayGrid(const Camera& camera);

  /// Direction of any place of the picture (not exactly of unit length); NaN where the camera has none.
  Eigen::Vector3d direction(double u, double v) const;
  /// The directions of the places (first, v) .. (first + count - 1, v).
  void row(double first, int count, double v, std::vector<Eigen::Vector3d>& directions) const;

  const Camera& camera() const { return camera_; }

 private:
  Eigen::Vector3d exact(double u, double v) const;
  const Eigen::Vector3d& node(int i, int j) const {
    return nodes_[static_cast<std::size_t>(j) * columns_ + i];
  }

  Camera camera_;
  int columns_ = 0, rows_ = 0;
  std::vector<Eigen::Vector3d> nodes_;
};

}  // namespace ca2
