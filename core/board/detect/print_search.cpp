#include "core/board/detect/print_search.h"

#include <algorithm>

#include "core/board/detect/print_place.h"
#include "core/board/detect/saddle_pyramid.h"

namespace ca2 {
namespace {

constexpr std::size_t least_corners = 4;
constexpr std::size_t most_pieces = 12;  // bounds the time on texture
constexpr double same_place = 3;         // px

/// The corners that pieces of one board show.
class PlacedCorners {
 public:
  explicit PlacedCorners(int columns) : columns_(columns) {}

  /// Unless it says otherwise than the pieces before.
  void add(const PrintMap& print, const PrintPiece& piece, const PrintPlace& place) {
    std::map<int, Eigen::Vector2d> pixels;
    for (const auto& [cell, pixel] : piece.corners) {
      const Cell at = place.corner(cell);
      if (!print.on_board(at)) continue;
      const int id = at.second * columns_ + at.first;
      const auto known = pixels_.find(id);
      if (known != pixels_.end() && (known->second - pixel).norm() > same_place) return;
      pixels[id] = pixel;
    }
    pixels_.merge(pixels);
  }

  std::vector<Corner> corners() const {
    std::vector<Corner> corners;
    for (const auto& [id, pixel] : pixels_)
      corners.push_back({id, pixel, Eigen::Matrix2d::Identity() * 0.04});
    return corners;
  }

 private:
  int columns_;
  std::map<int, Eigen::Vector2d> pixels_;  ///< by id
};

}  // namespace

std::vector<Corner> find_by_print(const Board& board, const SquarePrint& print, const Image& grey8) {
  if (grey8.empty()) return {};
  const Squares squares{std::min(Squares{}.plain, print.plain), Rings::small, print.gap};
  const std::vector<SaddleLevel> levels = saddle_levels(grey8);
  const std::vector<Saddle> saddles = strongest_saddles(levels, squares.rings);
  const PrintMap map(board, print);
  PlacedCorners placed(map.corner_columns());
  // Gives them back as they grew: they may go on in each other.
  const auto place = [&](const std::vector<Lattice>& pieces) {
    std::vector<Lattice> all;
    for (const Lattice& piece : pieces) {
      for (const Lines& lines : possible_lines(piece, squares)) {
        Lattice lattice = piece;
        grow(levels, lattice, map.most_corners(), squares, lines);
        if (lattice.size() > map.most_corners()) continue;
        const PrintPiece shown = print_piece(lattice, lines);
        if (const auto there = map.place_of(shown, grey8)) placed.add(map, shown, *there);
        all.push_back(std::move(lattice));
      }
    }
    return all;
  };
  const std::vector<Lattice> grown = place(
      connected_lattices(saddles, link_neighbours(levels, saddles, squares), least_corners, most_pieces));
  // Squares of 10 px and less leave a chessboard in pieces, of which none shows enough of the print.
  if (!print.tags()) place(merged_pieces(grown));
  return placed.corners();
}

}  // namespace ca2
