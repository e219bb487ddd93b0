/// @file Boards on sheets: the print is the board, at its true size.
#include "core/export/board/sheet.h"

#include <gtest/gtest.h>

#include <random>

#include "core/io/files.h"

namespace ca2 {
namespace {

Board board(const char* type, int columns, int rows, double square) {
  Board b;
  b.type = find_board_type(type);
  b.columns = columns;
  b.rows = rows;
  b.square = square;
  b.marker = type == std::string("charuco") ? 0.75 * square : 0;
  b.spacing = type == std::string("aprilgrid") ? 0.3 : 0;
  return b;
}

std::vector<Board> boards() {
  std::vector<Board> list;
  for (const BoardType* type : board_types()) {
    for (const auto& [columns, rows] : {std::pair(8, 5), std::pair(3, 4), std::pair(7, 7)}) {
      list.push_back(board(std::string(type->name()).c_str(), columns, rows, 0.0231));
    }
  }
  return list;
}

TEST(PatternInk, CoversWhatIsBlackOnceAndNothingElse) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(-0.55, 0.55);
  for (const Board& b : boards()) {
    SCOPED_TRACE(std::string(b.type->name()));
    const auto ink = pattern_ink(b);
    const Eigen::Vector2d size = b.type->pattern_size(b);
    for (int i = 0; i < 3000; ++i) {
      const Eigen::Vector2d p(unit(random) * size.x(), unit(random) * size.y());
      int covered = 0;
      double rim = 1;  // m, to the nearest edge
      for (const InkRectangle& r : ink) {
        const double dx = std::min(p.x() - r.x, r.x + r.width - p.x()),
                     dy = std::min(p.y() - r.y, r.y + r.height - p.y());
        covered += dx > 0 && dy > 0;
        rim = std::min({rim, std::abs(dx), std::abs(dy)});
      }
      if (rim < 1e-9) continue;
      EXPECT_EQ(covered, b.type->black(b, p)) << p.transpose();
    }
  }
}

TEST(Paper, NamesSizesAndMistakes) {
  EXPECT_DOUBLE_EQ(parse_paper("A4")->width, 0.297);
  EXPECT_DOUBLE_EQ(parse_paper("a3-portrait")->width, 0.297);
  EXPECT_DOUBLE_EQ(parse_paper("600x400")->height, 0.4);
  for (const char* wrong :
       {"", "A9", "600", "600x", "600x400x3", "-600x400", "1e9x400", "nanx400", "600x400-portrait"}) {
    const auto paper = parse_paper(wrong);
    ASSERT_FALSE(paper) << wrong;
    EXPECT_EQ(paper.error().code, ErrorCode::usage);
  }
}

TEST(Sheet, TheLargestSquareFitsAndOneMillimetreMoreDoesNot) {
  for (const char* name : {"A5", "A4", "A3-portrait", "1000x300"}) {
    const Paper paper = *parse_paper(name);
    for (Board b : boards()) {
      b.marker *= (b.square = largest_square(b, paper)) / 0.0231;
      ASSERT_GT(b.square, 0);
      EXPECT_TRUE(lay_out(b, paper)) << lay_out(b, paper).error().text();
      b.marker *= (b.square + 0.001) / b.square;
      b.square += 0.001;
      const auto more = lay_out(b, paper);
      ASSERT_FALSE(more);
      EXPECT_NE(more.error().text().find("--square"), std::string::npos);
    }
  }
}

TEST(Sheet, NothingIsOutsideOrNearThePattern) {
  for (const Board& b : boards()) {
    const auto sheet = lay_out(b, *parse_paper("A3"));
    ASSERT_TRUE(sheet);
    const Eigen::Vector2d half = b.type->pattern_size(b) / 2;
    for (const InkRectangle& r : sheet->ink) {
      EXPECT_GE(r.x, 0.005);
      EXPECT_LE(r.x + r.width, 0.415);
      EXPECT_LE(r.y + r.height, 0.292);
      const bool inside = r.y + r.height < sheet->origin.y() + half.y() + 1e-9;
      EXPECT_TRUE(inside || r.y > sheet->origin.y() + half.y() + 0.005);
    }
    // The plate's centre seen from the pattern's.
    EXPECT_NEAR((sheet->origin + sheet->outline.center - Eigen::Vector2d(0.21, 0.1485)).norm(), 0, 1e-12);
  }
}

TEST(Sheet, PngIsGreyByItsShareOfInk) {
  const auto sheet = lay_out(board("checkerboard", 8, 5, 0.02), *parse_paper("A4"));
  ASSERT_TRUE(sheet);
  const auto png = sheet_png(*sheet, 254);  // 0.1 mm per pixel
  ASSERT_TRUE(png);
  const auto image = decode_png(*png, "sheet");
  ASSERT_TRUE(image);
  EXPECT_EQ(image->width, 2970);
  EXPECT_EQ(image->height, 2100);
  double ink = 0, dark = 0;
  for (const InkRectangle& r : sheet->ink) ink += r.width * r.height;
  for (const std::uint8_t grey : image->bytes) dark += (255 - grey) / 255.0 * 1e-8;
  EXPECT_NEAR(dark / ink, 1, 1e-3);
  EXPECT_NE(png->find(std::string("pHYs\0\0\x27\x10\0\0\x27\x10\1", 13)), std::string::npos) << "10000 px/m";
  EXPECT_FALSE(sheet_png(*sheet, 1e6));
}

}  // namespace
}  // namespace ca2
