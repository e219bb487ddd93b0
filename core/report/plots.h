/// @file Plots as SVG in the page: sharp on every screen and in print, no script.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace ca2 {

/// How often values fall where; beyond the 1st and 99th percentile they count into the outer bars. `unit`
/// labels the axis. Empty for fewer than two values.
std::string histogram(std::vector<double> values, const std::string& unit);

/// A line through points, x rising, y >= 0.
struct Series {
  std::string name;
  std::vector<Eigen::Vector2d> points;
};
std::string line_plot(const std::vector<Series>& series, const std::string& x, const std::string& y);

/// Dots in a frame of `width` x `height`, y down: what the board has covered of a picture. A colour per
/// group.
struct Dot {
  double x = 0, y = 0;
  int group = 0;
};
std::string dot_plot(const std::vector<Dot>& dots, double width, double height);

/// Directions as seen along -z, from the unit disc's middle (0 degrees) to its rim (90): the boards' normals.
std::string direction_plot(const std::vector<Eigen::Vector3d>& directions);

/// The colour of the n-th group.
std::string group_colour(int group);

}  // namespace ca2
