/// @file Where a straight rim can be, by rays of which some ended on the plate and others did not.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

namespace ca2 {

/// The places (u, v) that are left for the two ends of a rim: a convex polygon, since every ray bounds a
/// linear function of them. Never allocates.
class RimPolygon {
 public:
  /// At first both ends are within `reach` of `middle`.
  RimPolygon(double middle, double reach);
  // Most have a few corners of the many that there is room for.
  RimPolygon(const RimPolygon& other) { *this = other; }
  RimPolygon& operator=(const RimPolygon& other) {
    count_ = other.count_;
    std::copy_n(other.corners_.begin(), count_, corners_.begin());
    return *this;
  }

  /// Leaves where weights.(u, v) <= bound. A polygon with as many corners as there is room for is left as it
  /// is: no more could be cut off than hardly anything.
  void cut(const Eigen::Vector2d& weights, double bound);
  bool empty() const { return count_ == 0; }
  /// Does weights.(u, v) <= bound limit it: does a corner lie on that line?
  bool limited_by(const Eigen::Vector2d& weights, double bound) const;
  double area() const;

  /// Mean and covariance of a place anywhere in the polygon with the same chance.
  struct Moments {
    Eigen::Vector2d mean;
    Eigen::Matrix2d covariance;
  };
  Moments moments() const;

 private:
  static constexpr std::size_t most = 32;
  std::span<const Eigen::Vector2d> corners() const { return {corners_.data(), count_}; }

  std::array<Eigen::Vector2d, most> corners_;  ///< the first so many, in order round it
  std::size_t count_ = 0;
};

}  // namespace ca2
