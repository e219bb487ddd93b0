/// AprilGrid, as Kalibr prints it: `columns` x `rows` tags of the family 36h11 with a border of two cells,
/// ids row by row from the bottom left; in the gaps between them (`spacing` times the tag's size) a black
/// square touches every corner of a tag, so that the corner is a crossing of two straight edges.
#include <algorithm>
#include <array>

#include "core/board/board.h"
#include "core/board/detect/print_search.h"
#include "core/board/types/aprilgrid_prints.h"
#include "core/board/types/lattice.h"

namespace ca2 {
namespace {

constexpr int cells = aprilgrid_cells;

/// Position along one axis: which tag's place, and where in it; before the tag comes its gap.
struct Along {
  int index;
  double inside;  ///< of the tag, 0..1; below 0 in the gap before it
};

Along along(double position, int tags, const Board& board) {
  const double gap = board.spacing, period = 1 + gap;
  const double u = position / board.square + 0.5 * (tags * period + gap);
  const double index = std::floor(u / period);
  // Far outside, the cast to int would be undefined.
  if (!(std::abs(index) < 1e6)) return {-1, 0};
  return {static_cast<int>(index), u - index * period - gap};
}

class Aprilgrid final : public BoardType {
 public:
  std::string_view name() const override { return "aprilgrid"; }

  std::vector<std::string> invalid(const Board& board) const override {
    std::vector<std::string> problems;
    check_count(problems, "columns", board.columns, 1);
    check_count(problems, "rows", board.rows, 1);
    check_square(problems, board.square);
    if (problems.empty() && board.columns * board.rows < 2)
      problems.push_back("an aprilgrid needs at least 2 tags");
    if (problems.empty() && board.columns * board.rows > static_cast<int>(aprilgrid_prints().size())) {
      problems.push_back("the board needs " + std::to_string(board.columns * board.rows) +
                         " tags and 36h11 has " + std::to_string(aprilgrid_prints().size()));
    }
    // The squares in the gaps are what makes a tag's corner a crossing.
    if (!(board.spacing >= 0.1 && board.spacing <= 1)) {
      problems.push_back("spacing is " + std::to_string(board.spacing) +
                         ", not in 0.1..1 (it is the gap between tags over their size; Kalibr's is 0.3)");
    }
    return problems;
  }

  std::vector<Eigen::Vector2d> corners(const Board& board) const override {
    std::vector<Eigen::Vector2d> points;
    const auto position = [&](int index, int tags) {
      const double left = (index / 2 - 0.5 * (tags - 1)) * (1 + board.spacing) - 0.5;
      return (left + index % 2) * board.square;
    };
    for (int row = 0; row < 2 * board.rows; ++row) {
      for (int column = 0; column < 2 * board.columns; ++column) {
        points.emplace_back(position(column, board.columns), position(row, board.rows));
      }
    }
    return points;
  }

  Eigen::Vector2d pattern_size(const Board& board) const override {
    return Eigen::Vector2d(board.columns * (1 + board.spacing) + board.spacing,
                           board.rows * (1 + board.spacing) + board.spacing) *
           board.square;
  }

  bool black(const Board& board, const Eigen::Vector2d& p) const override {
    const Along x = along(p.x(), board.columns, board), y = along(p.y(), board.rows, board);
    const bool gap_x = x.inside < 0, gap_y = y.inside < 0;
    // A last gap follows the last tag.
    if (x.index < 0 || y.index < 0 || x.index > board.columns - !gap_x || y.index > board.rows - !gap_y)
      return false;
    if (gap_x || gap_y) return gap_x && gap_y;
    const auto cell = [](double inside) {
      return std::clamp(static_cast<int>(inside * cells), 0, cells - 1);
    };
    const int id = (board.rows - 1 - y.index) * board.columns + x.index;
    return !aprilgrid_prints()[static_cast<std::size_t>(id)][static_cast<std::size_t>(cell(y.inside))]
                              [static_cast<std::size_t>(cell(x.inside))];
  }

  bool half_turn_ambiguous(const Board&) const override { return false; }

  std::vector<Corner> find(const Board& board, const Image& grey8) const override {
    constexpr double border = 1.0 * aprilgrid_border / cells;
    const SquarePrint print{cells - 2 * aprilgrid_border, 1 - 2 * border, std::min(border, board.spacing),
                            board.spacing};
    return find_by_print(board, print, grey8);
  }
};

}  // namespace

const BoardType& aprilgrid_board() {
  static const Aprilgrid type;
  return type;
}

}  // namespace ca2
