#include "core/solve/rim_polygon.h"

#include <algorithm>
#include <cmath>

namespace ca2 {

RimPolygon::RimPolygon(double middle, double reach) {
  for (const auto& [u, v] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
    corners_.emplace_back(middle + u * reach, middle + v * reach);
}

void RimPolygon::cut(const Eigen::Vector2d& weights, double bound) {
  if (!exceeds(weights, bound)) return;
  next_.clear();
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    const Eigen::Vector2d& here = corners_[i];
    const Eigen::Vector2d& there = corners_[(i + 1) % corners_.size()];
    const double excess = weights.dot(here) - bound, next_excess = weights.dot(there) - bound;
    if (excess <= 0) next_.push_back(here);
    if ((excess < 0 && next_excess > 0) || (excess > 0 && next_excess < 0))
      next_.push_back(here + excess / (excess - next_excess) * (there - here));
  }
  corners_.swap(next_);
  if (corners_.size() < 3) corners_.clear();
}

bool RimPolygon::exceeds(const Eigen::Vector2d& weights, double bound) const {
  return std::any_of(corners_.begin(), corners_.end(),
                     [&](const Eigen::Vector2d& corner) { return weights.dot(corner) > bound; });
}

bool RimPolygon::limited_by(const Eigen::Vector2d& weights, double bound) const {
  constexpr double rounding = 1e-12;  // rad
  return std::any_of(corners_.begin(), corners_.end(), [&](const Eigen::Vector2d& corner) {
    return std::abs(weights.dot(corner) - bound) < rounding;
  });
}

double RimPolygon::area() const {
  double twice = 0;
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    const Eigen::Vector2d& next = corners_[(i + 1) % corners_.size()];
    twice += corners_[i].x() * next.y() - corners_[i].y() * next.x();
  }
  return 0.5 * std::abs(twice);
}

RimPolygon::Moments RimPolygon::moments() const {
  // A fan of triangles from the first corner: each by its corners' moments.
  double area = 0;
  Eigen::Vector2d first = Eigen::Vector2d::Zero();
  Eigen::Matrix2d second = Eigen::Matrix2d::Zero();
  for (std::size_t i = 1; i + 1 < corners_.size(); ++i) {
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
