/// @file What the boards made of black and white squares share.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <string>
#include <vector>

namespace ca2 {

/// Positions of `columns` x `rows` lattice points, row by row, centred on the origin; m, board frame.
inline std::vector<Eigen::Vector2d> centred_lattice(int columns, int rows, double pitch) {
  std::vector<Eigen::Vector2d> points;
  points.reserve(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      points.emplace_back((column - 0.5 * (columns - 1)) * pitch, (row - 0.5 * (rows - 1)) * pitch);
    }
  }
  return points;
}

/// Column and row of the square that contains a point, and the point inside it in units of the square.
struct SquareAt {
  int column = 0;
  int row = 0;
  Eigen::Vector2d inside;  ///< 0..1 from the square's top-left corner
};

/// The square of a pattern of `columns` x `rows` squares centred on the origin; the pattern may not contain
/// the point: then column or row are out of range.
inline SquareAt square_at(int columns, int rows, double square, const Eigen::Vector2d& p) {
  const double u = p.x() / square + 0.5 * columns;
  const double v = p.y() / square + 0.5 * rows;
  // Far outside, a cast to int would be undefined.
  if (!(std::abs(u) < 1e6 && std::abs(v) < 1e6)) return {-1, -1, {0, 0}};
  const auto below = [](double x) {
    const int cut = static_cast<int>(x);
    return cut > x ? cut - 1 : cut;
  };
  const int column = below(u), row = below(v);
  return {column, row, {u - column, v - row}};
}

/// Complaints about a count and a length that every such board has.
inline void check_count(std::vector<std::string>& problems, const char* name, int value, int least) {
  if (value < least || value > 200) {
    problems.push_back(std::string(name) + " is " + std::to_string(value) + ", not in " +
                       std::to_string(least) + "..200");
  }
}

inline void check_square(std::vector<std::string>& problems, double square) {
  if (!(square >= 1e-4 && square <= 10)) {
    problems.push_back("square is " + std::to_string(square) + " m, not in 0.0001..10");
  }
}

}  // namespace ca2
