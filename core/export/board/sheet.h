/// @file A board on a sheet of paper, at its true size.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/board/board.h"
#include "core/types/result.h"

namespace ca2 {

/// Paper as it lies: wider than high is landscape.
struct Paper {
  double width = 0, height = 0;  ///< m
};

/// "A4", "A3-portrait", "letter", or "600x400" in mm. A series lies on its long side unless it says
/// "-portrait".
Result<Paper> parse_paper(std::string_view text);

/// Black, on white. From the sheet's top-left corner, m, y down.
struct InkRectangle {
  double x = 0, y = 0, width = 0, height = 0;
};

struct Sheet {
  Paper paper;
  std::vector<InkRectangle> ink;  ///< they do not overlap
  /// Where the board's origin is on the sheet, m: corners of the print are at this plus BoardType::corners.
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();
  /// The sheet as the board's plate: what to give as `outline` if the sheet is cut to the plate's size.
  Outline outline;
};

/// The pattern in the middle of the paper above a ruler and a line of text. ErrorCode::usage where the board
/// is wrong, or does not fit: then with the largest square that would.
Result<Sheet> lay_out(const Board& board, const Paper& paper);

/// The largest square (m, in whole millimetres) with which the board fits the paper; 0 where none does.
double largest_square(Board board, const Paper& paper);

/// The black of a pattern as rectangles that do not overlap, in the board's frame, whatever the type: its
/// edges are found in BoardType::black, which is all that a type says about its print.
std::vector<InkRectangle> pattern_ink(const Board& board);

/// One line of text in capitals as rectangles, its top left at (x, y), `height` m high. What the alphabet
/// lacks is left blank.
std::vector<InkRectangle> text_ink(std::string_view text, double x, double y, double height);
double text_width(std::string_view text, double height);

/// The sheet in files that print at true scale.
std::string sheet_svg(const Sheet& sheet);
std::string sheet_pdf(const Sheet& sheet);
/// Grey, each pixel as dark as its share of ink, with the resolution in the file. ErrorCode::usage beyond
/// 30000 pixels on a side.
Result<std::string> sheet_png(const Sheet& sheet, double dots_per_inch);

}  // namespace ca2
