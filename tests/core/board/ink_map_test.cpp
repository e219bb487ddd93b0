/// Spots on the print of every type of board: as black as the print is point by point.
#include "core/board/ink_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace ca2 {
namespace {

double black_points(const Board& board, const Eigen::Vector2d& p, double width) {
  constexpr int steps = 60;
  int black = 0;
  for (int i = 0; i < steps * steps; ++i) {
    const Eigen::Vector2d inside((i % steps + 0.5) / steps - 0.5, (i / steps + 0.5) / steps - 0.5);
    black += board.type->black(board, p + width * inside) ? 1 : 0;
  }
  return static_cast<double>(black) / (steps * steps);
}

TEST(InkMap, SpotsAreAsBlackAsThePrint) {
  std::mt19937_64 random(1);
  for (const BoardType* type : board_types()) {
    SCOPED_TRACE(std::string(type->name()));
    Board board;
    board.type = type;
    board.columns = 8;
    board.rows = 5;
    board.square = 0.04;
    board.marker = 0.03;
    board.spacing = 0.3;
    const InkMap ink(board);
    const Eigen::Vector2d half = 0.55 * type->pattern_size(board);  // and beside it
    std::uniform_real_distribution<double> x(-half.x(), half.x()), y(-half.y(), half.y());
    for (const double width : {0.008, 0.02, 0.05}) {
      double squares = 0;
      constexpr int spots = 200;
      for (int i = 0; i < spots; ++i) {
        const Eigen::Vector2d p(x(random), y(random));
        const double error = ink.share(p, width) - black_points(board, p, width);
        squares += error * error;
      }
      // Cells that the borders of squares and bits cut: the less, the larger the spot.
      EXPECT_LT(std::sqrt(squares / spots), 0.001 / width) << width;
    }
  }
}

TEST(InkMap, IsWhiteBesideThePrint) {
  Board board;
  board.type = find_board_type("checkerboard");
  board.columns = 8;
  board.rows = 5;
  board.square = 0.04;
  const InkMap ink(board);
  EXPECT_EQ(ink.share({1, 0}, 0.01), 0);
  EXPECT_EQ(ink.share({0, -1}, 0.01), 0);
  EXPECT_EQ(ink.share({1e9, 1e9}, 0.01), 0);
  EXPECT_EQ(ink.share({std::nan(""), 0}, 0.01), 0);
}

}  // namespace
}  // namespace ca2
