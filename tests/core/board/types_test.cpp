#include <gtest/gtest.h>

#include <random>

#include "core/board/board.h"
#include "core/session/board_type_hint.h"

namespace ca2 {
namespace {

Board checkerboard(int columns, int rows) {
  Board board;
  board.type = find_board_type("checkerboard");
  board.columns = columns;
  board.rows = rows;
  board.square = 0.04;
  return board;
}

Board charuco(int columns, int rows) {
  Board board = checkerboard(columns, rows);
  board.type = find_board_type("charuco");
  board.marker = 0.03;
  return board;
}

Board aprilgrid(int columns, int rows) {
  Board board = checkerboard(columns, rows);
  board.type = find_board_type("aprilgrid");
  board.spacing = 0.3;
  return board;
}

TEST(BoardTypes, AreFoundByName) {
  for (const BoardType* type : board_types()) EXPECT_EQ(find_board_type(type->name()), type);
  EXPECT_EQ(find_board_type("chequerboard"), nullptr);
}

TEST(BoardTypes, AnUnknownOneIsToldWhatToDo) {
  EXPECT_EQ(board_type_hint("chekerboard"), "did you mean 'checkerboard'?");
  if (!find_board_type("charuco")) {
    EXPECT_EQ(board_type_hint("charuco"),
              "this build was made without it: configure it with -DCA2_WITH_CHARUCO=ON");
  }
}

/// What every type promises, for boards of both parities.
TEST(BoardTypes, KeepTheirPromises) {
  std::mt19937_64 random(1);
  for (const BoardType* type : board_types()) {
    for (const auto& [columns, rows] : {std::pair(8, 6), std::pair(7, 5), std::pair(8, 5), std::pair(5, 8)}) {
      SCOPED_TRACE(std::string(type->name()) + " " + std::to_string(columns) + " x " + std::to_string(rows));
      Board board = charuco(columns, rows);
      board.type = type;
      board.spacing = 0.3;
      ASSERT_TRUE(type->invalid(board).empty()) << type->invalid(board).front();
      const Eigen::Vector2d size = type->pattern_size(board);
      Eigen::Vector2d centre = Eigen::Vector2d::Zero();
      for (const Eigen::Vector2d& corner : type->corners(board)) {
        centre += corner;
        EXPECT_LT(std::abs(corner.x()), size.x() / 2);
        EXPECT_LT(std::abs(corner.y()), size.y() / 2);
        // Every corner is a saddle: opposite quadrants alike, neighbouring ones not.
        const double e = board.square / 20;
        const auto black = [&](double x, double y) {
          return type->black(board, corner + Eigen::Vector2d(x, y));
        };
        EXPECT_EQ(black(e, e), black(-e, -e));
        EXPECT_EQ(black(e, -e), black(-e, e));
        EXPECT_NE(black(e, e), black(e, -e));
      }
      EXPECT_LT(centre.norm(), 1e-9);
      EXPECT_TRUE(type->black(board, -size / 2 + Eigen::Vector2d::Constant(1e-4)));
      EXPECT_FALSE(type->black(board, -size / 2 - Eigen::Vector2d::Constant(1e-4)));
      EXPECT_FALSE(type->black(board, Eigen::Vector2d(1e12, 0)));

      bool turns_into_itself = true;
      std::uniform_real_distribution<double> unit(-0.5, 0.5);
      for (int i = 0; i < 2000; ++i) {
        const Eigen::Vector2d p(unit(random) * size.x(), unit(random) * size.y());
        turns_into_itself &= type->black(board, p) == type->black(board, -p);
      }
      EXPECT_EQ(type->half_turn_ambiguous(board), turns_into_itself);
    }
  }
}

TEST(Checkerboard, CountsInnerCornersRowByRow) {
  const Board board = checkerboard(8, 6);
  const auto corners = board.type->corners(board);
  ASSERT_EQ(corners.size(), 48u);
  EXPECT_TRUE(corners[0].isApprox(Eigen::Vector2d(-0.14, -0.10)));
  EXPECT_TRUE(corners[1].isApprox(Eigen::Vector2d(-0.10, -0.10)));
  EXPECT_TRUE(corners[8].isApprox(Eigen::Vector2d(-0.14, -0.06)));
  EXPECT_TRUE(board.type->pattern_size(board).isApprox(Eigen::Vector2d(0.36, 0.28)));
}

TEST(Checkerboard, SaysWhatIsWrong) {
  Board board = checkerboard(2, 6);
  board.square = 0;
  EXPECT_EQ(board.type->invalid(board).size(), 2u);
  board = checkerboard(6, 6);
  EXPECT_TRUE(board.type->invalid(board).empty());
  board.outline = Outline{0.42, 0.297, Eigen::Vector2d::Zero()};
  EXPECT_EQ(board.type->invalid(board).size(), 1u);
}

TEST(Charuco, SaysWhatIsWrong) {
  Board board = charuco(30, 20);
  if (board.type == nullptr) GTEST_SKIP() << "built without ChArUco";
  EXPECT_EQ(board.type->invalid(board).size(), 1u);  // 300 markers of 100
  board.dictionary = "DICT_5X5";
  EXPECT_EQ(board.type->invalid(board).size(), 1u);
  board = charuco(5, 4);
  board.marker = 0.05;
  EXPECT_EQ(board.type->invalid(board).size(), 1u);
}

/// `black` is the very board that the library reads: a drawing of it is detected with every id in place.
void expect_drawing_is_read(const Board& board, double pixels_per_square) {
  const double scale = pixels_per_square / board.square;  // px/m
  const Eigen::Vector2d size = board.type->pattern_size(board) * scale + Eigen::Vector2d::Constant(120);
  Image image{static_cast<int>(size.x()), static_cast<int>(size.y()), 1, 8, {}};
  const Eigen::Vector2d middle(0.5 * (image.width - 1), 0.5 * (image.height - 1));
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      image.bytes.push_back(board.type->black(board, (Eigen::Vector2d(x, y) - middle) / scale) ? 0 : 255);
    }
  }
  const auto corners = board.type->corners(board);
  const auto found = board.type->find(board, image);
  ASSERT_EQ(found.size(), corners.size());
  for (const Corner& corner : found) {
    EXPECT_LT((corner.pixel - (middle + corners[static_cast<std::size_t>(corner.id)] * scale)).norm(), 0.75);
  }
}

TEST(Charuco, DrawsWhatTheDetectorReads) {
  for (const auto& [columns, rows] : {std::pair(8, 6), std::pair(7, 5), std::pair(5, 8)}) {
    const Board board = charuco(columns, rows);
    if (board.type == nullptr) GTEST_SKIP() << "built without ChArUco";
    expect_drawing_is_read(board, 60);
  }
}

TEST(Aprilgrid, DrawsWhatTheDetectorReads) {
  for (const auto& [columns, rows] : {std::pair(6, 6), std::pair(5, 4), std::pair(4, 7)}) {
    expect_drawing_is_read(aprilgrid(columns, rows), 80);
  }
}

/// Kalibr's numbering: ids from the bottom left. Its first tag's print, from tag36h11's published picture
/// 00000
/// ("d5d628584", most significant bit first, row by row).
TEST(Aprilgrid, FirstTagIsAtTheBottomLeft) {
  const Board board = aprilgrid(3, 2);
  const Eigen::Vector2d bottom_left =
      Eigen::Vector2d(-1, 1).cwiseProduct(board.type->pattern_size(board)) / 2;
  constexpr std::uint64_t code = 0xd5d628584;
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column) {
      const Eigen::Vector2d from_top_left_of_tag((column + 2.5) / 10, (row + 2.5) / 10);
      const Eigen::Vector2d top_left = bottom_left + Eigen::Vector2d(0.3, -1.3) * board.square;
      const bool white = (code >> (35 - 6 * row - column)) & 1;
      EXPECT_EQ(board.type->black(board, top_left + from_top_left_of_tag * board.square), !white)
          << row << column;
    }
  }
}

TEST(Aprilgrid, SaysWhatIsWrong) {
  Board board = aprilgrid(30, 20);  // 600 tags of 587
  EXPECT_EQ(board.type->invalid(board).size(), 1u);
  board = aprilgrid(6, 6);
  board.spacing = 0;
  EXPECT_EQ(board.type->invalid(board).size(), 1u);
  EXPECT_EQ(aprilgrid(1, 1).type->invalid(aprilgrid(1, 1)).size(), 1u);
}

TEST(Board, ExtentIsTheOutlineOrThePattern) {
  Board board = checkerboard(8, 6);
  EXPECT_DOUBLE_EQ(board.extent().width, 0.36);
  board.outline = Outline{0.42, 0.297, {0.001, 0}};
  EXPECT_DOUBLE_EQ(board.extent().width, 0.42);
  EXPECT_DOUBLE_EQ(board.extent().center.x(), 0.001);
}

}  // namespace
}  // namespace ca2
