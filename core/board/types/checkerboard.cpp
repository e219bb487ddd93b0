/// The plain checkerboard: `columns` x `rows` INNER corners, (columns + 1) x (rows + 1) squares, the top-left
/// one black.
#include "core/board/board.h"
#include "core/board/detect/checkerboard_search.h"
#include "core/board/types/lattice.h"

namespace ca2 {
namespace {

class Checkerboard final : public BoardType {
 public:
  std::string_view name() const override { return "checkerboard"; }

  std::vector<std::string> invalid(const Board& board) const override {
    std::vector<std::string> problems;
    // With two corners in a row there is no telling a board from the corner of a window frame.
    check_count(problems, "columns", board.columns, 3);
    check_count(problems, "rows", board.rows, 3);
    check_square(problems, board.square);
    const bool quarter_turn = board.columns == board.rows && board.columns % 2 == 0;
    const bool outline_turns =
        !board.outline || (board.outline->width == board.outline->height && board.outline->center.isZero());
    if (quarter_turn && !outline_turns) {
      problems.push_back(
          "a checkerboard with equal and even columns and rows looks the same after a quarter turn, so an "
          "outline that does not cannot be placed");
    }
    return problems;
  }

  std::vector<Eigen::Vector2d> corners(const Board& board) const override {
    return centred_lattice(board.columns, board.rows, board.square);
  }

  Eigen::Vector2d pattern_size(const Board& board) const override {
    return {(board.columns + 1) * board.square, (board.rows + 1) * board.square};
  }

  bool black(const Board& board, const Eigen::Vector2d& p) const override {
    const SquareAt at = square_at(board.columns + 1, board.rows + 1, board.square, p);
    return at.column >= 0 && at.row >= 0 && at.column <= board.columns && at.row <= board.rows &&
           (at.column + at.row) % 2 == 0;
  }

  bool half_turn_ambiguous(const Board& board) const override {
    // Half a turn brings square (i, j) to (columns - i, rows - j): the same colour when the sum is even.
    return (board.columns + board.rows) % 2 == 0;
  }

  bool repeats(const Board&) const override { return true; }

  std::vector<Corner> find(const Board& board, const Image& grey8) const override {
    return find_checkerboard(board.columns, board.rows, grey8);
  }
};

}  // namespace

const BoardType& checkerboard_board() {
  static const Checkerboard type;
  return type;
}

}  // namespace ca2
