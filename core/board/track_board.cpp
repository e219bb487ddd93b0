#include "core/board/track_board.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <map>

#include "core/board/detect/corner_search.h"
#include "core/board/refine/neighbourhood.h"

namespace ca2 {
namespace {

constexpr double reach = 0.35;       // of a spacing: half of one away the next corner is as near
constexpr double least_share = 0.6;  // of the expected corners
constexpr double least_agreement =
    0.75;  // of the samples that tell a shift; a shifted board has half or less

class Tracker {
 public:
  Tracker(const Board& board, const Image& grey8)
      : board_(board),
        grey8_(grey8),
        search_(board, grey8),
        points_(board.type->corners(board)),
        pitch_(corner_pitch(points_)) {}

  std::vector<Corner> run(std::span<const Corner> expected) const {
    const auto enough = [&](const std::vector<Corner>& corners) {
      return corners.size() >= 6 &&
             static_cast<double>(corners.size()) >= least_share * static_cast<double>(expected.size());
    };
    std::vector<Corner> corners = search_.find(expected, reach);
    if (!enough(corners)) return {};
    corners = without_strays(expected, corners);
    search_.grow(corners, reach);
    std::sort(corners.begin(), corners.end(), [](const Corner& a, const Corner& b) { return a.id < b.id; });
    return enough(corners) && in_place(corners) ? corners : std::vector<Corner>{};
  }

 private:
  /// Those that moved with the others: the picture's motion is affine to within a part of a square.
  std::vector<Corner> without_strays(std::span<const Corner> expected,
                                     const std::vector<Corner>& found) const {
    std::map<int, Eigen::Vector2d> before;
    for (const Corner& corner : expected) before[corner.id] = corner.pixel;
    const auto count = static_cast<Eigen::Index>(found.size());
    Eigen::MatrixX3d place(count, 3);
    Eigen::MatrixX2d motion(count, 2);
    for (Eigen::Index i = 0; i < count; ++i) {
      const Corner& corner = found[static_cast<std::size_t>(i)];
      place.row(i) << 1, points_[static_cast<std::size_t>(corner.id)].transpose() / pitch_;
      motion.row(i) = corner.pixel - before[corner.id];
    }
    const Eigen::MatrixX2d off = motion - place * place.colPivHouseholderQr().solve(motion);
    const auto lattice = neighbourhoods(points_, found);
    std::vector<Corner> kept;
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (!lattice[i]) continue;
      const double spacing = std::min(lattice[i]->reach[0], lattice[i]->reach[1]);
      if (off.row(static_cast<Eigen::Index>(i)).norm() < 0.12 * spacing + 0.5) kept.push_back(found[i]);
    }
    return kept;
  }

  /// Not a square or two away from where the ids say? A print that repeats itself is placed by its rim, any
  /// other by what is printed.
  bool in_place(const std::vector<Corner>& corners) const {
    return board_.type->repeats(board_) ? rim_seen(corners) : agreement(corners) >= least_agreement;
  }

  /// Is more than half of each of the four outer lines there? A shifted board lacks a line.
  bool rim_seen(const std::vector<Corner>& corners) const {
    Eigen::Vector2d half = Eigen::Vector2d::Zero();
    for (const Eigen::Vector2d& p : points_) half = half.cwiseMax(p);
    const auto on_side = [&](const Eigen::Vector2d& p, int side) {
      const int axis = side / 2;
      return std::abs(p[axis] - (side % 2 == 0 ? half[axis] : -half[axis])) < 0.5 * pitch_;
    };
    for (int side = 0; side < 4; ++side) {
      const auto all = std::count_if(points_.begin(), points_.end(),
                                     [&](const Eigen::Vector2d& p) { return on_side(p, side); });
      const auto seen = std::count_if(corners.begin(), corners.end(), [&](const Corner& corner) {
        return on_side(points_[static_cast<std::size_t>(corner.id)], side);
      });
      if (2 * seen <= all) return false;
    }
    return true;
  }

  /// Of the places round the corners where a print shifted by a square each way would look different (one to
  /// the side makes black of white, which right_sense sees): the share that is as bright as it should be.
  double agreement(const std::vector<Corner>& corners) const {
    const auto lattice = neighbourhoods(points_, corners);
    int total = 0;
    int agree = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      if (!lattice[i]) continue;
      const auto grey_at = [&](const Eigen::Vector2d& step) {
        const Eigen::Vector2d p =
            corners[i].pixel + lattice[i]->along[0] * step.x() + lattice[i]->along[1] * step.y();
        const auto x = std::clamp<long>(std::lround(p.x()), 0, grey8_.width - 1);
        const auto y = std::clamp<long>(std::lround(p.y()), 0, grey8_.height - 1);
        return grey8_.bytes[static_cast<std::size_t>(y) * static_cast<std::size_t>(grey8_.width) +
                            static_cast<std::size_t>(x)];
      };
      const Eigen::Vector2d corner = points_[static_cast<std::size_t>(corners[i].id)];
      double middle = 0;
      for (const double x : {-0.1, 0.1}) {
        for (const double y : {-0.1, 0.1}) middle += grey_at({x, y}) / 4.0;
      }
      for (int y = -4; y <= 4; ++y) {
        for (int x = -4; x <= 4; ++x) {
          const Eigen::Vector2d step(x / 5.0, y / 5.0);
          const Eigen::Vector2d p = corner + pitch_ * step;
          const bool black = board_.type->black(board_, p);
          if (black == board_.type->black(board_, p + Eigen::Vector2d::Constant(pitch_)) ||
              at_edge(p, black)) {
            continue;
          }
          ++total;
          agree += black == (grey_at(step) < middle) ? 1 : 0;
        }
      }
    }
    return total > 0 ? static_cast<double>(agree) / total : 0;
  }

  /// Does the print change its colour next to a place of this colour?
  bool at_edge(const Eigen::Vector2d& p, bool black) const {
    const double off = 0.04 * pitch_;
    for (const Eigen::Vector2d& d : {Eigen::Vector2d(off, 0), Eigen::Vector2d(-off, 0),
                                     Eigen::Vector2d(0, off), Eigen::Vector2d(0, -off)}) {
      if (board_.type->black(board_, p + d) != black) return true;
    }
    return false;
  }

  const Board& board_;
  const Image& grey8_;
  CornerSearch search_;
  std::vector<Eigen::Vector2d> points_;
  double pitch_;
};

}  // namespace

std::vector<Corner> track_board(const Board& board, const Image& grey8, std::span<const Corner> expected) {
  if (grey8.empty() || expected.size() < 6) return {};
  return Tracker(board, grey8).run(expected);
}

}  // namespace ca2
