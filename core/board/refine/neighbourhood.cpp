#include "core/board/refine/neighbourhood.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

namespace ca2 {
namespace {

using Cell = std::pair<long, long>;

/// The distinct coordinates of the corners on one axis, rising; a micrometre apart is the same line.
std::vector<double> lines(const std::vector<Eigen::Vector2d>& board_points, int axis) {
  std::vector<double> all;
  for (const Eigen::Vector2d& point : board_points) all.push_back(point[axis]);
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end(), [](double a, double b) { return b - a < 1e-6; }), all.end());
  return all;
}

long nearest_line(const std::vector<double>& lines, double value) {
  const auto above = std::lower_bound(lines.begin(), lines.end(), value - 1e-6);
  return above - lines.begin();
}

}  // namespace

double corner_pitch(const std::vector<Eigen::Vector2d>& board_points) {
  double pitch = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 2; ++axis) {
    const std::vector<double> at = lines(board_points, axis);
    for (std::size_t i = 1; i < at.size(); ++i) pitch = std::min(pitch, at[i] - at[i - 1]);
  }
  return pitch;
}

std::vector<std::optional<Neighbourhood>> neighbourhoods(const std::vector<Eigen::Vector2d>& board_points,
                                                         std::span<const Corner> corners) {
  const double pitch = corner_pitch(board_points);
  const std::array<std::vector<double>, 2> at{lines(board_points, 0), lines(board_points, 1)};
  const auto cell_of = [&](const Corner& corner) {
    const Eigen::Vector2d& point = board_points[static_cast<std::size_t>(corner.id)];
    return Cell(nearest_line(at[0], point.x()), nearest_line(at[1], point.y()));
  };
  // Pitches from a cell to the next one on an axis, which is on the board.
  const auto step = [&](const Cell& cell, int axis, long by) {
    const std::vector<double>& line = at[static_cast<std::size_t>(axis)];
    const auto index = static_cast<std::size_t>(axis == 0 ? cell.first : cell.second);
    return std::abs(line[index + static_cast<std::size_t>(by)] - line[index]) / pitch;
  };
  std::map<Cell, Eigen::Vector2d> pixels;
  for (const Corner& corner : corners) pixels[cell_of(corner)] = corner.pixel;
  const auto pixel_at = [&](const Cell& cell) -> const Eigen::Vector2d* {
    const auto it = pixels.find(cell);
    return it == pixels.end() ? nullptr : &it->second;
  };
  const auto moved = [](const Cell& cell, int axis, long by) {
    return axis == 0 ? Cell(cell.first + by, cell.second) : Cell(cell.first, cell.second + by);
  };
  struct Bend {
    Eigen::Vector2d second;  // derivative of the pixel, px per pitch^2
    double curvature;
  };
  // Of three corners in a line.
  const auto bend = [&](const Cell& cell, int axis) -> std::optional<Bend> {
    const Eigen::Vector2d* before = pixel_at(moved(cell, axis, -1));
    const Eigen::Vector2d* here = pixel_at(cell);
    const Eigen::Vector2d* after = pixel_at(moved(cell, axis, 1));
    if (before == nullptr || here == nullptr || after == nullptr) return std::nullopt;
    const double b = step(cell, axis, -1), a = step(cell, axis, 1);
    const Eigen::Vector2d forward = (*after - *here) / a, back = (*here - *before) / b;
    const Eigen::Vector2d second = 2 / (a + b) * (forward - back);
    const Eigen::Vector2d first = (b * forward + a * back) / (a + b);
    const Eigen::Vector2d left(-first.y(), first.x());
    // The line is at left . d = k (first . d)^2 with k = second / 2; the model's c is
    // n . d + curvature (t . d)^2 = 0 on it.
    return Bend{second, -0.5 * left.dot(second) / std::pow(first.norm(), 3)};
  };
  std::vector<std::optional<Neighbourhood>> result;
  for (const Corner& corner : corners) {
    const Cell cell = cell_of(corner);
    std::optional<Neighbourhood> found = Neighbourhood{};
    for (int axis = 0; axis < 2; ++axis) {
      const Eigen::Vector2d* before = pixel_at(moved(cell, axis, -1));
      const Eigen::Vector2d* after = pixel_at(moved(cell, axis, 1));
      if (before == nullptr && after == nullptr) {
        found.reset();
        break;
      }
      // At the end of a line the next corner's bend is the best guess: in pixels, for the spacing shrinks;
      // and it goes on changing as it does from the one after that to the next.
      const long beside = before != nullptr && after != nullptr ? 0 : (after != nullptr ? 1 : -1);
      auto bent = bend(moved(cell, axis, beside), axis);
      if (const auto beyond = bend(moved(cell, axis, 2 * beside), axis); beside != 0 && bent && beyond) {
        const auto pixel = [&](long by) { return *pixel_at(moved(cell, axis, by * beside)); };
        const double ratio = (pixel(1) - pixel(0)).norm() / (pixel(2) - pixel(1)).norm();
        // On small squares the difference of two curvatures is noise.
        if ((pixel(1) - pixel(0)).norm() > 12)
          bent->curvature += ratio * (bent->curvature - beyond->curvature);
      }
      const Eigen::Vector2d second = bent ? bent->second : Eigen::Vector2d::Zero();
      Eigen::Vector2d& along = found->along[axis];
      // The parabola through the corner and its neighbours: its slope at the corner.
      if (after != nullptr) {
        const double a = step(cell, axis, 1);
        along = (*after - corner.pixel) / a - 0.5 * a * second;
      } else {
        const double b = step(cell, axis, -1);
        along = (corner.pixel - *before) / b + 0.5 * b * second;
      }
      double& reach = found->reach[axis];
      reach = along.norm();
      if (before != nullptr) reach = std::min(reach, (corner.pixel - *before).norm());
      if (after != nullptr) reach = std::min(reach, (*after - corner.pixel).norm());
      if (bent) found->curvature[axis] = bent->curvature;
    }
    result.push_back(found);
  }
  return result;
}

}  // namespace ca2
