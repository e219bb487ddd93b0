/// @file Where a straight rim can be, by rays of which some ended on the plate and others did not.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace ca2 {

/// The places (u, v) that are left for the two ends of a rim: a convex polygon, since every ray bounds a
/// linear function of them.
class RimPolygon {
 public:
  /// At first both ends are within `reach` of `middle`.
  RimPolygon(double middle, double reach);

  /// Leaves where weights.(u, v) <= bound.
  void cut(const Eigen::Vector2d& weights, double bound);
  bool empty() const { return corners_.empty(); }
  /// Is there a place with more than that?
  bool exceeds(const Eigen::Vector2d& weights, double bound) const;
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
  std::vector<Eigen::Vector2d> corners_;  ///< in order round it
  std::vector<Eigen::Vector2d> next_;     ///< while cutting
};

}  // namespace ca2
