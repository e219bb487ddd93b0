#include "core/board/detect/corner_search.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/board/detect/saddle_pyramid.h"

namespace ca2 {
namespace {

constexpr int most_reach = 16;       // px of a level: a board that leaps further is searched anew
constexpr double least_spacing = 8;  // px of a level: on a coarser one, what covers a corner is blurred away

}  // namespace

CornerSearch::CornerSearch(const Board& board, const Image& grey8)
    : board_(board),
      grey8_(grey8),
      points_(board.type->corners(board)),
      pitch_(corner_pitch(points_)),
      rings_(board.type->repeats(board) ? Rings::usual : Rings::small) {}

std::vector<Corner> CornerSearch::find(std::span<const Corner> expected, double reach) const {
  return find_from(expected, 0, reach);
}

std::size_t CornerSearch::grow(std::vector<Corner>& corners, double reach) const {
  const std::vector<Corner> more = find_from(with_neighbours(corners), corners.size(), reach);
  corners.insert(corners.end(), more.begin(), more.end());
  return more.size();
}

std::vector<Corner> CornerSearch::find_from(std::span<const Corner> expected, std::size_t first,
                                            double reach) const {
  const auto lattice = neighbourhoods(points_, expected);
  std::vector<Corner> found;
  for (std::size_t i = first; i < expected.size(); ++i) {
    if (!lattice[i]) continue;
    if (const auto pixel = corner_near(expected[i], *lattice[i], reach)) {
      found.push_back({expected[i].id, *pixel, Eigen::Matrix2d::Identity() * 0.04});
    }
  }
  return found;
}

/// On the finest level that shows a corner of the right sense, as the search of the whole picture has it.
std::optional<Eigen::Vector2d> CornerSearch::corner_near(const Corner& expected, const Neighbourhood& lattice,
                                                         double reach_in_spacings) const {
  const double spacing = std::min(lattice.reach[0], lattice.reach[1]);
  for (int level = 0; level < saddle_level_count; ++level) {
    const double reach = std::min(reach_in_spacings * spacing / (1 << level), 1.0 * most_reach);
    if (level > 0 && spacing < least_spacing * (1 << level)) break;
    const std::vector<SaddleLevel> window{
        saddle_window(grey8_, level, expected.pixel, static_cast<int>(std::ceil(reach)))};
    for (const Saddle& saddle : strongest_saddles(window, rings_)) {
      const double off = (saddle.pixel - expected.pixel).norm() / (1 << level);
      if (off <= reach && right_sense(expected.id, lattice, saddle.e0 + saddle.e1)) return saddle.pixel;
    }
  }
  return std::nullopt;
}

/// Do black and white lie round the saddle as the board prints them round the corner?
bool CornerSearch::right_sense(int id, const Neighbourhood& lattice, const Eigen::Vector2d& direction) const {
  Eigen::Matrix2d pixel_by_board;
  pixel_by_board << lattice.along[0], lattice.along[1];
  // In the board's axes: the sign of x * y is the pair of opposite squares that the direction points into.
  const Eigen::Vector2d bright = pixel_by_board.inverse() * direction;
  const Eigen::Vector2d inside = Eigen::Vector2d::Constant(0.02 * pitch_);
  const bool main_black = board_.type->black(board_, points_[static_cast<std::size_t>(id)] + inside);
  return (bright.x() * bright.y() > 0) != main_black;
}

std::vector<Corner> CornerSearch::with_neighbours(const std::vector<Corner>& found) const {
  std::vector<Corner> all = found;
  std::vector<bool> known(points_.size(), false);
  for (const Corner& corner : found) known[static_cast<std::size_t>(corner.id)] = true;
  const auto lattice = neighbourhoods(points_, found);
  for (std::size_t id = 0; id < points_.size(); ++id) {
    for (std::size_t i = 0; i < found.size() && !known[id]; ++i) {
      const Eigen::Vector2d step = (points_[id] - points_[static_cast<std::size_t>(found[i].id)]) / pitch_;
      if (!lattice[i] || step.norm() > 1.01) continue;
      const Eigen::Vector2d pixel =
          found[i].pixel + lattice[i]->along[0] * step.x() + lattice[i]->along[1] * step.y();
      all.push_back({static_cast<int>(id), pixel, Eigen::Matrix2d::Identity()});
      known[id] = true;
    }
  }
  return all;
}

}  // namespace ca2
