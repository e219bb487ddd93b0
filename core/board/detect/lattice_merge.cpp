#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/board/detect/lattice.h"

namespace ca2 {
namespace {

/// Squares between two pieces of one board at most: lines bend in a fisheye.
constexpr double farthest = 3;
/// Squares by which a corner may lie beside where another piece's lattice goes on.
constexpr double off = 0.3;

Eigen::Vector2d place_of(const Cell& cell) {
  return {cell.first, cell.second};
}

/// A lattice as straight lines go on from round one of its corners.
struct Grid {
  Cell origin;
  Eigen::Vector2d pixel;         ///< of the origin
  Eigen::Matrix2d cell_of_step;  ///< cells per px
  double pitch = 0;              ///< px, the longer side of a square

  Eigen::Vector2d cell(const Eigen::Vector2d& at) const {
    return place_of(origin) + cell_of_step * (at - pixel);
  }
};

/// From the corners round `origin`, nearer ones with more weight; nothing where they lie on a line.
std::optional<Grid> grid_at(const Lattice& lattice, const Cell& origin) {
  const Eigen::Vector2d at = lattice.at(origin).saddle.pixel;
  Eigen::Matrix2d cells = Eigen::Matrix2d::Zero(), both = Eigen::Matrix2d::Zero();
  for (const auto& [cell, node] : lattice) {
    const Eigen::Vector2d away = place_of(cell) - place_of(origin);
    if (away.squaredNorm() == 0) continue;
    const double weight = 1 / (away.squaredNorm() * away.squaredNorm());
    cells += weight * away * away.transpose();
    both += weight * (node.saddle.pixel - at) * away.transpose();
  }
  if (!(cells.determinant() > 1e-6 * cells.squaredNorm())) return std::nullopt;
  const Eigen::Matrix2d step_of_cell = both * cells.inverse();
  if (!(std::abs(step_of_cell.determinant()) > 1)) return std::nullopt;
  return Grid{origin, at, step_of_cell.inverse(),
              std::max(step_of_cell.col(0).norm(), step_of_cell.col(1).norm())};
}

/// Both pieces' corners that are nearest to each other.
std::pair<Cell, Cell> nearest(const Lattice& a, const Lattice& b) {
  std::pair<Cell, Cell> best;
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [cell_a, node_a] : a) {
    for (const auto& [cell_b, node_b] : b) {
      const double distance = (node_a.saddle.pixel - node_b.saddle.pixel).squaredNorm();
      if (distance < least) least = distance, best = {cell_a, cell_b};
    }
  }
  return best;
}

/// On a chessboard the bright fields of neighbouring corners lie along the one diagonal and the other.
bool bright_along(const Cell& cell, const Node& node) {
  const int x = node.step[0].first + node.step[1].first, y = node.step[0].second + node.step[1].second;
  return (x == y) == ((cell.first + cell.second) % 2 == 0);
}

/// How cells of one lattice are numbered in another.
struct Renumbering {
  Eigen::Matrix2i axes;  ///< columns: where the axes go
  Eigen::Vector2i offset;

  Cell step(const Cell& by) const {
    const Eigen::Vector2i to = axes * Eigen::Vector2i(by.first, by.second);
    return {to.x(), to.y()};
  }
  Cell operator()(const Cell& cell) const {
    const Cell to = step(cell);
    return {to.first + offset.x(), to.second + offset.y()};
  }
};

/// Nothing where `b` does not lie on the lattice that `a` goes on to be.
std::optional<Renumbering> numbered_as(const Lattice& a, const Lattice& b) {
  const auto [cell_a, cell_b] = nearest(a, b);
  const auto grid_a = grid_at(a, cell_a), grid_b = grid_at(b, cell_b);
  if (!grid_a || !grid_b) return std::nullopt;
  if ((grid_a->pixel - grid_b->pixel).norm() > farthest * grid_a->pitch) return std::nullopt;
  const Eigen::Matrix2d axes = grid_a->cell_of_step * grid_b->cell_of_step.inverse();
  const Eigen::Vector2d there = grid_a->cell(grid_b->pixel);
  Renumbering as{axes.array().round().matrix().cast<int>(), {}};
  if (as.axes.cwiseAbs().sum() != 2 || std::abs(as.axes.determinant()) != 1) return std::nullopt;
  if ((axes - as.axes.cast<double>()).cwiseAbs().maxCoeff() > off) return std::nullopt;
  const Eigen::Vector2d rounded = there.array().round().matrix();
  if ((there - rounded).cwiseAbs().maxCoeff() > off) return std::nullopt;
  as.offset = rounded.cast<int>() - as.axes * Eigen::Vector2i(cell_b.first, cell_b.second);
  const bool parity = bright_along(cell_a, a.at(cell_a));
  for (const auto& [cell, node] : b) {
    const Cell to = as(cell);
    const auto same = a.find(to);  // both may have grown there
    if (same != a.end() && (same->second.saddle.pixel - node.saddle.pixel).norm() > off * grid_a->pitch)
      return std::nullopt;
    Node turned = node;
    for (Cell& step : turned.step) step = as.step(step);
    if (bright_along(to, turned) != parity) return std::nullopt;
  }
  return as;
}

}  // namespace

std::vector<Lattice> merged_pieces(std::vector<Lattice> pieces) {
  std::vector<Lattice> merged;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const std::size_t before = pieces.size();
    for (std::size_t k = i + 1; k < pieces.size();) {
      const auto as = numbered_as(pieces[i], pieces[k]);
      if (!as) {
        ++k;
        continue;
      }
      for (auto& [cell, node] : pieces[k]) {
        for (Cell& step : node.step) step = as->step(step);
        pieces[i][(*as)(cell)] = node;
      }
      pieces.erase(pieces.begin() + static_cast<std::ptrdiff_t>(k));
      k = i + 1;  // the larger piece reaches further
    }
    if (pieces.size() < before) merged.push_back(pieces[i]);
  }
  return merged;
}

}  // namespace ca2
