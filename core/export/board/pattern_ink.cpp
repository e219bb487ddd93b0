#include <algorithm>
#include <cmath>
#include <map>

#include "core/export/board/sheet.h"

namespace ca2 {
namespace {

/// Samples per square: no type has cells of a fiftieth of one.
constexpr int samples = 150;

/// All places where black changes to white along one axis somewhere, rising, with the pattern's two rims.
/// Edges are parallel to the axes.
std::vector<double> edges(const Board& board, int axis, const Eigen::Vector2d& size) {
  const Eigen::Vector2d half = size / 2;
  const auto black = [&](double along, double across) {
    return board.type->black(board,
                             axis == 0 ? Eigen::Vector2d(along, across) : Eigen::Vector2d(across, along));
  };
  const int steps = static_cast<int>(std::ceil(size[axis] / board.square * samples));
  // A second at most: boards of thousands of squares are the plainer ones.
  constexpr int most = 40'000'000;
  const int lines =
      std::min(static_cast<int>(std::ceil(size[1 - axis] / board.square * samples)), most / steps);
  const double step = size[axis] / steps;
  std::map<int, double> found;  // one per step
  for (int line = 0; line < lines; ++line) {
    const double across = (line + 0.5) / lines * size[1 - axis] - half[1 - axis];
    bool before = black(-half[axis] + 0.5 * step, across);
    for (int k = 1; k < steps; ++k) {
      const double at = -half[axis] + (k + 0.5) * step;
      const bool now = black(at, across);
      if (now != before && !found.count(k)) {
        double low = at - step, high = at;
        for (int round = 0; round < 60; ++round) {
          const double middle = 0.5 * (low + high);
          (black(middle, across) == before ? low : high) = middle;
        }
        found[k] = 0.5 * (low + high);
      }
      before = now;
    }
  }
  std::vector<double> all{-half[axis]};
  for (const auto& [k, edge] : found) all.push_back(edge);
  all.push_back(half[axis]);
  return all;
}

}  // namespace

std::vector<InkRectangle> pattern_ink(const Board& board) {
  const Eigen::Vector2d size = board.type->pattern_size(board);
  const std::vector<double> xs = edges(board, 0, size), ys = edges(board, 1, size);
  std::vector<InkRectangle> ink;
  // Runs of the row above, by where they begin, to be made taller where this row repeats them.
  std::map<std::size_t, std::pair<std::size_t, std::size_t>> above;  // begin -> end, index in `ink`
  for (std::size_t j = 0; j + 1 < ys.size(); ++j) {
    std::map<std::size_t, std::pair<std::size_t, std::size_t>> here;
    const auto black = [&](std::size_t i) {
      return board.type->black(board, {0.5 * (xs[i] + xs[i + 1]), 0.5 * (ys[j] + ys[j + 1])});
    };
    for (std::size_t i = 0; i + 1 < xs.size();) {
      if (!black(i)) {
        ++i;
        continue;
      }
      std::size_t end = i;
      while (end + 1 < xs.size() && black(end)) ++end;
      const auto same = above.find(i);
      if (same != above.end() && same->second.first == end) {
        here[i] = same->second;
        InkRectangle& taller = ink[same->second.second];
        taller.height = ys[j + 1] - taller.y;
      } else {
        here[i] = {end, ink.size()};
        ink.push_back({xs[i], ys[j], xs[end] - xs[i], ys[j + 1] - ys[j]});
      }
      i = end;
    }
    above = std::move(here);
  }
  return ink;
}

}  // namespace ca2
