#include "core/board/refine/neighbourhood.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace ca2 {
namespace {

using Cell = std::pair<long, long>;

}  // namespace

double corner_pitch(const std::vector<Eigen::Vector2d>& board_points) {
  double pitch = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < board_points.size(); ++i) {
    pitch = std::min(pitch, (board_points[i] - board_points[0]).norm());
  }
  return pitch;
}

std::vector<std::optional<Neighbourhood>> neighbourhoods(const std::vector<Eigen::Vector2d>& board_points,
                                                         std::span<const Corner> corners) {
  const double pitch = corner_pitch(board_points);
  const auto cell_of = [&](const Corner& corner) {
    const Eigen::Vector2d at = (board_points[static_cast<std::size_t>(corner.id)] - board_points[0]) / pitch;
    return Cell(std::lround(at.x()), std::lround(at.y()));
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
  // Second difference of three corners in a line.
  const auto bend = [&](const Cell& cell, int axis) -> std::optional<Eigen::Vector2d> {
    const Eigen::Vector2d* before = pixel_at(moved(cell, axis, -1));
    const Eigen::Vector2d* here = pixel_at(cell);
    const Eigen::Vector2d* after = pixel_at(moved(cell, axis, 1));
    if (before == nullptr || here == nullptr || after == nullptr) return std::nullopt;
    return *before + *after - 2 * *here;
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
      // At the end of a line the next corner's bend is the best guess.
      Eigen::Vector2d second = Eigen::Vector2d::Zero();
      for (const long by : {0L, after != nullptr ? 1L : -1L}) {
        if (const auto b = bend(moved(cell, axis, by), axis)) {
          second = *b;
          break;
        }
      }
      Eigen::Vector2d& along = found->along[axis];
      if (before != nullptr && after != nullptr) {
        along = 0.5 * (*after - *before);
      } else if (after != nullptr) {
        along = *after - corner.pixel - 0.5 * second;
      } else {
        along = corner.pixel - *before + 0.5 * second;
      }
      const double length = along.norm();
      double& reach = found->reach[axis];
      reach = length;
      if (before != nullptr) reach = std::min(reach, (corner.pixel - *before).norm());
      if (after != nullptr) reach = std::min(reach, (*after - corner.pixel).norm());
      const Eigen::Vector2d left(-along.y() / length, along.x() / length);
      // The line is at left . d = k (along . d)^2 / length^2 with k = second / 2; the model's z is
      // n . d + curvature (t . d)^2 = 0 on it.
      found->curvature[axis] = -0.5 * left.dot(second) / (length * length);
    }
    result.push_back(found);
  }
  return result;
}

}  // namespace ca2
