#include "core/export/board/sheet.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "core/types/text.h"

namespace ca2 {
namespace {

constexpr double margin = 0.010;      // m, printers leave a rim white; also the quiet zone round the pattern
constexpr double footer = 0.012;      // m, ruler and text
constexpr double millimetre = 0.001;  // m

struct NamedPaper {
  std::string_view name;
  double long_side, short_side;  ///< mm
};
constexpr std::array papers{
    NamedPaper{"A0", 1189, 841},        NamedPaper{"A1", 841, 594},          NamedPaper{"A2", 594, 420},
    NamedPaper{"A3", 420, 297},         NamedPaper{"A4", 297, 210},          NamedPaper{"A5", 210, 148},
    NamedPaper{"LETTER", 279.4, 215.9}, NamedPaper{"TABLOID", 431.8, 279.4},
};

std::string upper(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return result;
}

/// The room for the pattern.
Eigen::Vector2d room(const Paper& paper) {
  return {paper.width - 2 * margin, paper.height - 2 * margin - footer};
}

bool fits(const Board& board, const Paper& paper) {
  const Eigen::Vector2d size = board.type->pattern_size(board), space = room(paper);
  return size.x() <= space.x() + 1e-9 && size.y() <= space.y() + 1e-9;
}

/// A scale with a tick every millimetre, `length` m long, that goes up from (x, y).
void add_ruler(std::vector<InkRectangle>& ink, double x, double y, int millimetres) {
  constexpr double line = 0.0002;
  for (int k = 0; k <= millimetres; ++k) {
    const double height = (k % 10 == 0 ? 4 : k % 5 == 0 ? 3 : 2) * millimetre;
    ink.push_back({x + k * millimetre - line / 2, y - height, line, height});
  }
  const std::string length = std::to_string(millimetres) + " mm";
  for (const InkRectangle& dot : text_ink("0", x - 0.0007, y - 0.0062, 0.0018)) ink.push_back(dot);
  for (const InkRectangle& dot :
       text_ink(length, x + millimetres * millimetre - 0.0007, y - 0.0062, 0.0018)) {
    ink.push_back(dot);
  }
}

std::string description(const Board& board, const Paper& paper) {
  std::string text = std::string(board.type->name()) +
                     formatted(" %d x %d, square %.6g mm", board.columns, board.rows, 1e3 * board.square);
  if (board.marker > 0)
    text += formatted(", marker %.6g mm %s", 1e3 * board.marker, board.dictionary.c_str());
  if (board.spacing > 0) text += formatted(", spacing %.6g", board.spacing);
  return text + formatted(". print at 100 %% on %.6g x %.6g mm, measure the ruler", 1e3 * paper.width,
                          1e3 * paper.height);
}

}  // namespace

Result<Paper> parse_paper(std::string_view text) {
  std::string name = upper(text);
  constexpr std::string_view portrait_ending = "-PORTRAIT";
  const bool portrait = name.ends_with(portrait_ending);
  if (portrait) name.resize(name.size() - portrait_ending.size());
  for (const NamedPaper& paper : papers) {
    if (paper.name != name) continue;
    Paper found{paper.long_side * millimetre, paper.short_side * millimetre};
    if (portrait) std::swap(found.width, found.height);
    return found;
  }
  double width = 0, height = 0;
  const char* end = name.data() + name.size();
  auto read = std::from_chars(name.data(), end, width);
  if (read.ec == std::errc() && read.ptr != end && *read.ptr == 'X') {
    read = std::from_chars(read.ptr + 1, end, height);
    if (read.ec == std::errc() && read.ptr == end && !portrait && width >= 50 && height >= 50 &&
        width <= 5000 && height <= 5000) {
      return Paper{width * millimetre, height * millimetre};
    }
  }
  return fail(ErrorCode::usage, "", "'" + std::string(text) + "' is no paper",
              "A0 to A5, letter, tabloid, with -portrait or without, or WIDTHxHEIGHT in mm from 50 to 5000");
}

double largest_square(Board board, const Paper& paper) {
  const double marker_share = board.square > 0 ? board.marker / board.square : 0;
  for (int size = static_cast<int>(std::max(paper.width, paper.height) / millimetre); size > 0; --size) {
    board.square = size * millimetre;
    board.marker = marker_share * board.square;
    if (fits(board, paper)) return board.square;
  }
  return 0;
}

Result<Sheet> lay_out(const Board& board, const Paper& paper) {
  std::vector<Problem> problems;
  for (std::string& wrong : board.type->invalid(board)) problems.push_back({"", std::move(wrong), {}});
  if (!problems.empty()) return fail(ErrorCode::usage, problems);
  if (!fits(board, paper)) {
    const Eigen::Vector2d size = 1e3 * board.type->pattern_size(board), space = 1e3 * room(paper);
    const double largest = largest_square(board, paper);
    return fail(ErrorCode::usage, "",
                formatted("the pattern is %.6g x %.6g mm, the paper has room for %.6g x %.6g mm", size.x(),
                          size.y(), space.x(), space.y()),
                largest > 0 ? formatted("take a square of %.6g mm (--square %.6g) or a larger paper",
                                        1e3 * largest, largest)
                            : std::string("take fewer columns and rows or a larger paper"));
  }
  Sheet sheet;
  sheet.paper = paper;
  sheet.origin = {0.5 * paper.width, margin + 0.5 * room(paper).y()};
  sheet.outline = {paper.width, paper.height,
                   Eigen::Vector2d(0.5 * paper.width, 0.5 * paper.height) - sheet.origin};
  for (InkRectangle ink : pattern_ink(board)) {
    ink.x += sheet.origin.x();
    ink.y += sheet.origin.y();
    sheet.ink.push_back(ink);
  }
  const double bottom = paper.height - 0.006;
  // Whole centimetres, at most ten: what a ruler at hand can check; half of the sheet is for the text.
  const int ruler = std::clamp(static_cast<int>(0.35 * paper.width / millimetre) / 10 * 10, 10, 100);
  add_ruler(sheet.ink, margin, bottom, ruler);
  const double start = margin + ruler * millimetre + 0.012;
  const std::string text = description(board, paper);
  const double room_for_text = paper.width - margin - start;
  const double height = std::min(0.0025, 0.0025 * room_for_text / text_width(text, 0.0025));
  for (const InkRectangle& dot : text_ink(text, start, bottom - height, height)) sheet.ink.push_back(dot);
  return sheet;
}

}  // namespace ca2
