/// @file Chessboard lattices among the saddles of a picture.
#pragma once

#include <Eigen/Core>
#include <array>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "core/board/detect/saddle_pyramid.h"

namespace ca2 {

/// The four ways to leave a saddle along its edges: +e0, +e1, -e0, -e1.
inline Eigen::Vector2d slot_direction(const Saddle& saddle, int slot) {
  const Eigen::Vector2d& e = slot % 2 == 0 ? saddle.e0 : saddle.e1;
  return slot < 2 ? e : Eigen::Vector2d(-e);
}

/// The slot on whose side of this one it is bright.
inline int bright_slot(int slot) {
  return slot ^ 1;
}

/// How the squares of a chessboard are printed, as far as the search for its lattice must know.
struct Squares {
  /// Of a square's side: what is plain along its edges, where the edges are looked at.
  double plain = 0.36;
  Rings rings = Rings::usual;
  double gap = 0;  ///< between tags, in their sides; 0: a chessboard, whose squares are alike

  bool tags() const { return gap > 0; }
};

/// Which saddles are next to each other on a chessboard: for each and each slot the index of the neighbour
/// (both agree on it), or -1.
std::vector<std::array<int, 4>> link_neighbours(const std::vector<SaddleLevel>& levels,
                                                const std::vector<Saddle>& saddles, const Squares& squares);

/// Does a chessboard's edge run from a (leaving by `slot`) to b: bright on one side, dark on the other, all
/// the way?
bool edge_between(const std::vector<SaddleLevel>& levels, const Saddle& a, int slot, const Saddle& b,
                  const Squares& squares);

using Cell = std::pair<int, int>;  ///< (i, j): steps along the lattice's two axes

inline Cell operator+(const Cell& a, const Cell& b) {
  return {a.first + b.first, a.second + b.second};
}

/// A corner of a lattice, and which way its slots lead.
struct Node {
  Saddle saddle;
  std::array<Cell, 4> step;  ///< by slot
};

/// A connected piece of a chessboard. Ordered by cell: iteration is deterministic.
using Lattice = std::map<Cell, Node>;

/// Where the lines of corners lie, and which squares between them are printed on. Those of a chessboard are
/// one apart, its white squares are. On a grid of tags, whose corners are a chessboard's with every second
/// row and column of squares narrower, a tag is 1 wide and a gap `gap`.
struct Lines {
  double gap = 1;
  Cell first{0, 0};  ///< of a printed square: it lies beyond these lines along both axes
  bool tags = false;

  bool printed(const Cell& cell) const {
    const int i = cell.first - first.first, j = cell.second - first.second;
    return tags ? i % 2 == 0 && j % 2 == 0 : (i + j) % 2 == 0;
  }
  Eigen::Vector2d place(const Cell& cell) const {
    return {along(cell.first - first.first), along(cell.second - first.second)};
  }

 private:
  double along(int line) const {
    const int odd = line & 1;
    return (line - odd) / 2 * (1 + gap) + odd;
  }
};

/// The pieces with at least `least` corners, largest first, at most `most` of them.
std::vector<Lattice> connected_lattices(const std::vector<Saddle>& saddles,
                                        const std::vector<std::array<int, 4>>& links, std::size_t least,
                                        std::size_t most);

/// The ways to take a lattice for a piece of such a board: one of a chessboard's. On a grid of tags the
/// squares in the gaps are as black, and only smaller.
std::vector<Lines> possible_lines(const Lattice& lattice, const Squares& squares);

/// Looks for the corners missing in and around a lattice where its neighbours predict them, until nothing is
/// added or it has more than `most` corners.
void grow(const std::vector<SaddleLevel>& levels, Lattice& lattice, std::size_t most, const Squares& squares,
          const Lines& lines = {});

/// Makes one of pieces that go on in each other across a gap of a few squares, so far apart as no lattice
/// grows where single corners cannot be told. Only what is made of several is returned.
std::vector<Lattice> merged_pieces(std::vector<Lattice> pieces);

}  // namespace ca2
