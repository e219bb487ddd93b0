/// @file `ca2 board`: every printed page, drawn by programs of others, shows the board where it should be.
#include <cstdlib>

#include "core/export/board/sheet.h"
#include "core/io/files.h"
#include "core/session/rig.h"
#include "tests/tools/ca2/small_session.h"

namespace ca2 {
namespace {

using namespace ca2::test;
namespace fs = std::filesystem;

bool have(const char* program) {
  return std::system(("command -v " + std::string(program) + " >/dev/null 2>&1").c_str()) == 0;
}

/// Board and outline of the YAML beside a print.
Rig rig_of(const fs::path& yaml) {
  const auto rig = parse_rig("version: 1\n" + bytes_of(yaml) + "lidars: {top: {}}\n", yaml);
  EXPECT_TRUE(rig) << rig.error().text();
  return rig ? *rig : Rig{};
}

/// Corners as the detector finds them in a page, against where the sheet has them.
void expect_found(const fs::path& file, const Board& board, double dots_per_inch) {
  const auto image = read_png(file);
  ASSERT_TRUE(image) << image.error().text();
  const double scale = dots_per_inch / 0.0254;  // px/m
  const Outline& paper = *board.outline;
  const Eigen::Vector2d origin = Eigen::Vector2d(paper.width, paper.height) / 2 - paper.center;
  EXPECT_NEAR(image->width, paper.width * scale, 1.5);
  const auto corners = detect_board(board, *image);
  const auto all = board.type->corners(board);
  EXPECT_GE(corners.size(), board.type->name() == "checkerboard" ? all.size() : all.size() * 95 / 100);
  double worst = 0;
  for (const Corner& corner : corners) {
    // The centre of the first pixel is (0, 0): the page's rim is at -0.5. A checkerboard that may be turned
    // by half is none of those printed here.
    const Eigen::Vector2d truth =
        (origin + all[static_cast<std::size_t>(corner.id)]) * scale - Eigen::Vector2d::Constant(0.5);
    worst = std::max(worst, (corner.pixel - truth).norm());
  }
  EXPECT_LT(worst, 0.05) << file;
}

class BoardCommand : public testing::TestWithParam<const char*> {};

/// The pages as rasterisers draw them: area-sampled, without any blur.
TEST_P(BoardCommand, EveryPageIsFoundWhereItIsPrinted) {
  if (find_board_type(GetParam()) == nullptr) GTEST_SKIP() << "built without " << GetParam();
  const TemporaryDirectory folder;
  int renders = 0;
  for (const std::string paper : {"A4", "A3-portrait"}) {
    const fs::path base = folder / (GetParam() + ("_" + paper));
    const auto print = [&](const char* ending) {
      const Outcome run = run_ca2({"board", "--type", GetParam(), "--paper", paper, "--dpi", "100",
                                   "--output", base.string() + ending});
      EXPECT_EQ(run.status, 0) << run.errors;
      EXPECT_NE(run.output.find(base.string() + ".yaml"), std::string::npos);
    };
    print(".png");
    const Board board = rig_of(base.string() + ".yaml").board;
    ASSERT_NE(board.type, nullptr);
    expect_found(base.string() + ".png", board, 100);
    const fs::path page = base.string() + "_page.png";
    if (have("rsvg-convert")) {
      print(".svg");
      ASSERT_EQ(
          std::system(
              ("rsvg-convert --dpi-x 73 --dpi-y 73 " + base.string() + ".svg -o " + page.string()).c_str()),
          0);
      expect_found(page, board, 73);
      ++renders;
    }
    if (have("pdftocairo")) {
      print(".pdf");
      ASSERT_EQ(std::system(("pdftocairo -r 100 -png -singlefile " + base.string() + ".pdf " + base.string() +
                             "_page")
                                .c_str()),
                0);
      expect_found(page, board, 100);
      ++renders;
    }
  }
  if (renders == 0) GTEST_SKIP() << "only the PNG was tried: there is neither rsvg-convert nor pdftocairo";
}

INSTANTIATE_TEST_SUITE_P(Types, BoardCommand, testing::Values("checkerboard", "charuco", "aprilgrid"));

TEST(BoardFile, ChoosesWhatFitsAndObeysWhatIsAsked) {
  const TemporaryDirectory folder;
  Outcome run = run_ca2({"board", "--output", folder / "b.pdf"});
  ASSERT_EQ(run.status, 0) << run.errors;
  EXPECT_EQ(rig_of(folder / "b.yaml").board.square, 0.029);
  run = run_ca2({"board", "--columns", "6", "--rows", "7", "--square", "0.0215", "--paper", "A4-portrait",
                 "-o", folder / "b.svg"});
  ASSERT_EQ(run.status, 0) << run.errors;
  const Board board = rig_of(folder / "b.yaml").board;
  EXPECT_EQ(board.square, 0.0215);
  EXPECT_EQ(board.columns, 6);
  EXPECT_EQ(board.outline->height, 0.297);
}

TEST(BoardFile, MistakesSayWhatToDo) {
  const TemporaryDirectory folder;
  struct Case {
    std::vector<std::string> options;
    int status;
    const char* word;
  };
  const std::string file = folder / "b.pdf";
  const std::vector<Case> cases{
      {{"-o", folder / "b.jpg"}, 64, ".svg, .pdf and .png"},
      {{"-o", file, "--square", "0.1"}, 64, "--square 0.029"},
      {{"-o", file, "--paper", "B7"}, 64, "B7"},
      {{"-o", file, "--columns", "2"}, 64, "columns"},
      {{"-o", file, "--columns", "200", "--rows", "200"}, 64, "fewer columns"},
      {{"-o", file, "--type", "circles"}, 64, "circles"},
      {{"-o", file, "--marker", "0.01"}, 64, "--marker"},
      {{"-o", file, "--square", "nan"}, 64, "square"},
      {{"-o", "/proc/b.pdf"}, 73, "/proc/b.pdf"},
      {{}, 64, "--output"},
  };
  for (const Case& c : cases) {
    std::vector<std::string> words{"board"};
    words.insert(words.end(), c.options.begin(), c.options.end());
    const Outcome outcome = run_ca2(words);
    EXPECT_EQ(outcome.status, c.status) << c.word << ": " << outcome.errors;
    EXPECT_NE(outcome.errors.find(c.word), std::string::npos) << outcome.errors;
  }
  EXPECT_FALSE(fs::exists(file));
}

}  // namespace
}  // namespace ca2
