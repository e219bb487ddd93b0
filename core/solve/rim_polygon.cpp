#include "core/solve/rim_polygon.h"

#include <algorithm>
#include <cmath>

namespace ca2 {

RimPolygon::RimPolygon(double middle, double reach) {
  for (const auto& [u, v] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
    corners_[count_++] = {middle + u * reach, middle + v * reach};
}

void RimPolygon::cut(const Eigen::Vector2d& weights, double bound) {
  std::array<double, most> excess;
  bool any = false;
  for (std::size_t i = 0; i < count_; ++i) {
    excess[i] = weights.dot(corners_[i]) - bound;
    any = any || excess[i] > 0;
  }
  if (!any || count_ == most) return;
  std::array<Eigen::Vector2d, most> left;
  std::size_t count = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    const std::size_t next = i + 1 < count_ ? i + 1 : 0;
    if (excess[i] <= 0) left[count++] = corners_[i];
    if ((excess[i] < 0 && excess[next] > 0) || (excess[i] > 0 && excess[next] < 0))
      left[count++] = corners_[i] + excess[i] / (excess[i] - excess[next]) * (corners_[next] - corners_[i]);
  }
  count_ = count < 3 ? 0 : count;
  std::copy_n(left.begin(), count_, corners_.begin());
}

bool RimPolygon::limited_by(const Eigen::Vector2d& weights, double bound) const {
  constexpr double rounding = 1e-12;  // rad
  return std::ranges::any_of(corners(), [&](const Eigen::Vector2d& corner) {
    return std::abs(weights.dot(corner) - bound) < rounding;
  });
}

double RimPolygon::area() const {
  double twice = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    const Eigen::Vector2d& next = corners_[(i + 1) % count_];
    twice += corners_[i].x() * next.y() - corners_[i].y() * next.x();
  }
  return 0.5 * std::abs(twice);
}

RimPolygon::Moments RimPolygon::moments() const {
  // A fan of triangles from the first corner: each by its corners' moments.
  double area = 0;
  Eigen::Vector2d first = Eigen::Vector2d::Zero();
  Eigen::Matrix2d second = Eigen::Matrix2d::Zero();
  for (std::size_t i = 1; i + 1 < count_; ++i) {
    const Eigen::Vector2d a = corners_[i] - corners_[0], b = corners_[i + 1] - corners_[0];
    const double triangle = 0.5 * std::abs(a.x() * b.y() - a.y() * b.x());
    const Eigen::Vector2d sum = a + b;
    area += triangle;
    first += triangle / 3 * sum;
    second += triangle / 12 * (a * a.transpose() + b * b.transpose() + sum * sum.transpose());
  }
  if (!(area > 0)) return {corners_[0], Eigen::Matrix2d::Zero()};
  const Eigen::Vector2d mean = first / area;
  return {corners_[0] + mean, second / area - mean * mean.transpose()};
}

}  // namespace ca2
