/// @file Where in its plane a rectangle of known size lies.
#pragma once

#include <cstdint>
#include <span>

namespace ca2 {

/// Where a ray meets the plane, and what that says: positive for a return on
/// the plane, negative for a ray that went through it.
struct PlaneSample {
  float u, v;           ///< m, in the plane
  std::int32_t weight;  ///< of being inside the rectangle; a whole number, so that ties are ties
};

/// Centre in the plane (m) and the angle of the width side (rad, in [0, pi)).
struct PlaneRectangle {
  double u = 0, v = 0, angle = 0;
  std::int32_t weight = 0;      ///< sum of the weights inside
  double cosine = 1, sine = 0;  ///< of the angle

  /// Coordinates along the rectangle's sides, from its centre.
  void local(double pu, double pv, double& x, double& y) const {
    x = cosine * (pu - u) + sine * (pv - v);
    y = cosine * (pv - v) - sine * (pu - u);
  }
  void turn(double to);
};

/// The pose of the rectangle with the largest weight inside; where many are as
/// good (rings lie far apart), the middle of them. Deterministic.
PlaneRectangle fit_rectangle(std::span<const PlaneSample> samples, double width, double height);

}  // namespace ca2
