#include "tools/sim/ray_grid.h"

#include <array>
#include <cmath>
#include <limits>

namespace ca2 {
namespace {

constexpr int step = 2;    // px between nodes
constexpr int border = 2;  // nodes outside the picture on every side, for the stencil

/// Lagrange weights of the nodes -1, 0, 1, 2 at s in [0, 1].
std::array<double, 4> cubic_weights(double s) {
  return {-s * (s - 1) * (s - 2) / 6, (s + 1) * (s - 1) * (s - 2) / 2, -(s + 1) * s * (s - 2) / 2,
          (s + 1) * s * (s - 1) / 6};
}

}  // namespace

RayGrid::RayGrid(const Camera& camera) : camera_(camera) {
  columns_ = (camera.width + step - 1) / step + 2 * border + 1;
  rows_ = (camera.height + step - 1) / step + 2 * border + 1;
  nodes_.reserve(static_cast<std::size_t>(columns_) * rows_);
  for (int j = 0; j < rows_; ++j) {
    for (int i = 0; i < columns_; ++i) {
      nodes_.push_back(exact(step * (i - border), step * (j - border)));
    }
  }
}

Eigen::Vector3d RayGrid::exact(double u, double v) const {
  const auto direction = camera_.unproject({u, v});
  return direction ? *direction : Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
}

Eigen::Vector3d RayGrid::direction(double u, double v) const {
  const double x = u / step + border, y = v / step + border;
  const int i = static_cast<int>(std::floor(x)), j = static_cast<int>(std::floor(y));
  if (i < 1 || j < 1 || i + 2 >= columns_ || j + 2 >= rows_) return exact(u, v);
  const auto wx = cubic_weights(x - i), wy = cubic_weights(y - j);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int b = 0; b < 4; ++b) {
    for (int a = 0; a < 4; ++a) {
      sum += wx[static_cast<std::size_t>(a)] * wy[static_cast<std::size_t>(b)] * node(i + a - 1, j + b - 1);
    }
  }
  // Beside the rim of the model's domain a node of the stencil is missing.
  return std::isnan(sum.x()) ? exact(u, v) : sum;
}

void RayGrid::row(double first, int count, double v, std::vector<Eigen::Vector3d>& directions) const {
  const double y = v / step + border;
  const int j = static_cast<int>(std::floor(y));
  const auto wy = cubic_weights(y - j);
  std::vector<Eigen::Vector3d> line(static_cast<std::size_t>(columns_));
  for (int i = 0; i < columns_; ++i) {
    Eigen::Vector3d& sum = line[static_cast<std::size_t>(i)];
    sum.setZero();
    for (int b = 0; b < 4; ++b) sum += wy[static_cast<std::size_t>(b)] * node(i, j + b - 1);
  }
  directions.resize(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k) {
    const double x = (first + k) / step + border;
    const int i = static_cast<int>(std::floor(x));
    const auto wx = cubic_weights(x - i);
    Eigen::Vector3d& sum = directions[static_cast<std::size_t>(k)];
    sum.setZero();
    for (int a = 0; a < 4; ++a) {
      sum += wx[static_cast<std::size_t>(a)] * line[static_cast<std::size_t>(i + a - 1)];
    }
    if (std::isnan(sum.x())) sum = exact(first + k, v);
  }
}

}  // namespace ca2
