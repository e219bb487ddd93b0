/// `ca2 board`: a board to print, and the YAML that goes with it.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "core/export/board/sheet.h"
#include "core/io/files.h"
#include "core/session/board_type_hint.h"
#include "core/session/board_yaml.h"
#include "tools/ca2/command.h"
#include "tools/ca2/number_in.h"

namespace ca2 {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string type = "checkerboard", paper = "A4", output, dictionary = Board().dictionary;
  std::optional<int> columns, rows;
  std::optional<double> square, marker, spacing;
  double dpi = 300;
};

/// What is usual for a type: odd beside even, so that a checkerboard looks different after half a turn.
Board usual_board(const Options& options) {
  Board board;
  board.type = find_board_type(options.type);
  const bool grid = options.type == "aprilgrid";
  board.columns = options.columns.value_or(grid ? 6 : 8);
  board.rows = options.rows.value_or(grid ? 4 : 5);
  board.dictionary = options.dictionary;
  if (options.type == "charuco") board.marker = 0.75;  // of the square, until that is known
  if (grid) board.spacing = options.spacing.value_or(0.3);
  return board;
}

Result<Board> choose_board(const Options& options, const Paper& paper) {
  Board board = usual_board(options);
  // Counts that are no board have no size to fit.
  board.square = 1;
  for (std::string& wrong : board.type->invalid(board)) return fail(ErrorCode::usage, "", std::move(wrong));
  if (options.marker && options.type != "charuco") {
    return fail(ErrorCode::usage, "--marker", "only charuco boards have markers", "leave it out");
  }
  if (options.spacing && options.type != "aprilgrid") {
    return fail(ErrorCode::usage, "--spacing", "only aprilgrids have a spacing", "leave it out");
  }
  const double largest = largest_square(board, paper);
  if (!options.square && largest <= 0) {
    return fail(ErrorCode::usage, "", "the paper has no room for squares of a millimetre",
                "take fewer columns and rows or a larger paper");
  }
  const double share = board.marker;
  board.square = options.square.value_or(largest);
  board.marker = options.marker.value_or(share * board.square);
  return board;
}

std::string yaml(const Sheet& sheet, Board board) {
  board.outline = sheet.outline;
  return "# Printed by ca2 board. Measure the ruler on the print: squares that are 1 % too large move "
         "everything by 1 %.\n"
         "# The outline is the sheet's own, as a plate cut to it would have; correct it to the plate you "
         "mount it on\n"
         "# (width, height; centre of the plate minus centre of the pattern, x right, y down), or leave it "
         "out.\n" +
         write_board(board);
}

Result<int> draw(const Options& options) {
  const fs::path output = options.output;
  const std::string ending = output.extension().string();
  if (ending != ".svg" && ending != ".pdf" && ending != ".png") {
    return fail(ErrorCode::usage, "--output " + options.output, "ends in none of .svg, .pdf and .png");
  }
  const Result<Paper> paper = parse_paper(options.paper);
  if (!paper) return fail(paper.error());
  const Result<Board> board = choose_board(options, *paper);
  if (!board) return fail(board.error());
  const Result<Sheet> sheet = lay_out(*board, *paper);
  if (!sheet) return fail(sheet.error());
  const Result<std::string> drawing = ending == ".png"   ? sheet_png(*sheet, options.dpi)
                                      : ending == ".svg" ? Result<std::string>(sheet_svg(*sheet))
                                                         : Result<std::string>(sheet_pdf(*sheet));
  if (!drawing) return fail(drawing.error());
  fs::path description = output;
  description.replace_extension(".yaml");
  if (const auto written = write_atomically(output, *drawing); !written) return fail(written.error());
  if (const auto written = write_atomically(description, yaml(*sheet, *board)); !written)
    return fail(written.error());
  std::printf("%s\n%s\n", output.string().c_str(), description.string().c_str());
  return 0;
}

}  // namespace

CommandBody setup_board(CLI::App& app) {
  auto options = std::make_shared<Options>();
  std::string types;
  for (const BoardType* type : board_types()) {
    types += (types.empty() ? "{" : ",") + std::string(type->name());
  }
  const auto unknown = [](const std::string& name) {
    return find_board_type(name) ? "" : "there is no board type '" + name + "'; " + board_type_hint(name);
  };
  app.add_option("--type", options->type, "Kind of board")
      ->check(CLI::Validator(unknown, types + "}"))
      ->capture_default_str();
  app.add_option("--paper", options->paper,
                 "A0 to A5, letter, tabloid, with -portrait or without, or WIDTHxHEIGHT in mm")
      ->capture_default_str();
  app.add_option("--output,-o", options->output,
                 "File to write: .svg, .pdf or .png; its .yaml goes beside it")
      ->required()
      ->type_name("FILE");
  app.add_option(
         "--columns", options->columns,
         "checkerboard: inner corners along x; charuco: squares; aprilgrid: tags (default: 8; aprilgrid: 6)")
      ->check(number_in(1, 1000));
  app.add_option("--rows", options->rows, "The same along y (default: 5; aprilgrid: 4)")
      ->check(number_in(1, 1000));
  app.add_option("--square", options->square,
                 "Side of a square, aprilgrid: of a tag, m (default: the most whole millimetres that fit)")
      ->check(number_in(1e-3, 10));
  app.add_option("--marker", options->marker, "charuco: side of a marker, m (default: 3/4 of the square)")
      ->check(number_in(1e-3, 10));
  app.add_option("--dictionary", options->dictionary, "charuco: OpenCV's name of the markers")
      ->capture_default_str();
  app.add_option("--spacing", options->spacing, "aprilgrid: gap over tag (default: 0.3, as Kalibr's)")
      ->check(number_in(0, 10));
  app.add_option("--dpi", options->dpi, "PNG: pixels per inch")
      ->check(number_in(20, 2400))
      ->capture_default_str();
  app.footer(
      "Print at 100 % (no \"fit to page\") and measure the ruler. Glue it on a flat, stiff plate. The YAML "
      "is the\n"
      "board: of session.yaml and ca2d.yaml. Larger is better: A3 reaches some 4 m with a 64-beam LiDAR, A4 "
      "some 2 m.");
  return [options] { return draw(*options); };
}

}  // namespace ca2
