#include <gtest/gtest.h>

#include "tests/support/board_renderer.h"
#include "tests/support/board_scenes.h"

namespace ca2 {
namespace {

Board aprilgrid(int columns, int rows) {
  Board board = test::make_board("aprilgrid", columns, rows, 0.05);
  board.spacing = 0.3;
  return board;
}

/// Views through both lenses, whole, tilted and cut by the picture's rim: every id in its place, and corners
/// as good as a chessboard's, since they are crossings too.
TEST(Aprilgrid, IsRefinedWholeAndInPart) {
  const Board board = aprilgrid(6, 5);
  struct View {
    Camera camera;
    Eigen::Vector3d bearing;
    double distance, tilt, roll;
    std::size_t least;  ///< corners, of 120
  };
  const View views[] = {{test::narrow_camera(), {0, 0.1, 1}, 0.9, 0.2, 0.5, 115},
                        {test::narrow_camera(), {0, 0.1, 1}, 1.2, 0.9, 0.5, 115},
                        {test::narrow_camera(), {0.5, 0.1, 1}, 0.9, 0.2, 0.5, 40},
                        {test::narrow_camera(), {0, 0, 1}, 1.0, 0.3, 2.5, 115},
                        {test::fisheye_camera(), {0, 0.1, 1}, 0.3, 0.2, 0.5, 105}};
  std::mt19937_64 random(7);
  for (const View& view : views) {
    const Pose truth = test::board_pose(view.bearing, view.distance, view.tilt, 1.2, view.roll);
    const auto pixels = test::true_corners(board, view.camera, truth);
    const auto corners = detect_board(board, test::render_board(board, view.camera, truth, {}, random));
    EXPECT_GE(corners.size(), view.least);
    double sum = 0;
    for (const Corner& corner : corners) {
      const auto& pixel = pixels[static_cast<std::size_t>(corner.id)];
      ASSERT_TRUE(pixel);
      EXPECT_LT((corner.pixel - *pixel).norm(), 0.25) << corner.id;
      sum += (corner.pixel - *pixel).squaredNorm();
    }
    EXPECT_LT(std::sqrt(sum / static_cast<double>(corners.size())), 0.05);
    const auto pose = estimate_board_pose(board, view.camera, corners);
    ASSERT_TRUE(pose) << pose.error().text();
    EXPECT_LT(truth.difference(pose->T_camera_board).norm(), 0.01);
  }
}

/// Where all corners that were found are where they should be, how many there are.
std::size_t right_corners(const Board& board, const Camera& camera, const Pose& truth,
                          const test::RenderOptions& look, std::mt19937_64& random) {
  const auto pixels = test::true_corners(board, camera, truth);
  const auto corners = detect_board(board, test::render_board(board, camera, truth, look, random));
  for (const Corner& corner : corners) {
    const auto& pixel = pixels[static_cast<std::size_t>(corner.id)];
    if (!pixel || (corner.pixel - *pixel).norm() > 0.5) return 0;
  }
  return corners.size();
}

/// Gaps from a tenth of a tag to a whole one, and boards of two tags only.
TEST(Aprilgrid, IsFoundWhateverItsGaps) {
  std::mt19937_64 random(11);
  for (const double spacing : {0.1, 0.2, 0.5, 1.0}) {
    Board board = test::make_board("aprilgrid", 4, 3, 0.06);
    board.spacing = spacing;
    const Pose truth = test::board_pose({0.05, 0, 1}, 1.0, 0.7, 2.0, 0.4);
    EXPECT_EQ(right_corners(board, test::narrow_camera(), truth, {}, random), 48u) << spacing;
  }
  const Pose truth = test::board_pose({0, 0, 1}, 0.8, 0.4, 2.0, 1.9);
  EXPECT_EQ(right_corners(aprilgrid(2, 1), test::narrow_camera(), truth, {}, random), 8u);
}

/// Far away and at the rim of a fisheye the cells of a tag are too small to be read, one by one.
TEST(Aprilgrid, IsFoundWhereItsTagsAreSmall) {
  std::mt19937_64 random(12);
  const Camera camera = test::fisheye_camera();
  int found = 0;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d bearing(0.9 * std::cos(0.8 * i), 0.9 * std::sin(0.8 * i), 1);
    const Pose truth = test::board_pose(bearing, 0.55, 0.3, 0.7 * i, 0.5 * i);
    found += right_corners(aprilgrid(6, 5), camera, truth, {}, random) >= 100 ? 1 : 0;
  }
  EXPECT_GE(found, 7);
}

/// An AprilGrid whose tags are turned in their places, as some generators print them.
class TurnedTags final : public BoardType {
 public:
  explicit TurnedTags(int turns) : turns_(turns) {}
  std::string_view name() const override { return "turned"; }
  std::vector<std::string> invalid(const Board&) const override { return {}; }
  std::vector<Eigen::Vector2d> corners(const Board& board) const override { return grid_.corners(board); }
  Eigen::Vector2d pattern_size(const Board& board) const override { return grid_.pattern_size(board); }
  bool black(const Board& board, const Eigen::Vector2d& p) const override {
    const double period = (1 + board.spacing) * board.square;
    const auto middle = [&](double x, int tags) {
      return (std::round(x / period - 0.5 * (tags - 1)) + 0.5 * (tags - 1)) * period;
    };
    const Eigen::Vector2d tag(middle(p.x(), board.columns), middle(p.y(), board.rows));
    Eigen::Vector2d inside = p - tag;
    if (inside.cwiseAbs().maxCoeff() > 0.5 * board.square) return grid_.black(board, p);
    for (int k = 0; k < turns_; ++k) inside = {-inside.y(), inside.x()};
    return grid_.black(board, tag + inside);
  }
  bool half_turn_ambiguous(const Board&) const override { return false; }
  std::vector<Corner> find(const Board&, const Image&) const override { return {}; }

 private:
  const BoardType& grid_ = *find_board_type("aprilgrid");
  int turns_;
};

TEST(Aprilgrid, IsFoundWithItsTagsTurned) {
  const Camera camera = test::narrow_camera();
  const Pose truth = test::board_pose({0, 0.05, 1}, 0.9, 0.4, 2.0, 0.9);
  for (int turns = 1; turns < 4; ++turns) {
    const TurnedTags type(turns);
    const Board board = aprilgrid(6, 5);
    Board printed = board;
    printed.type = &type;
    std::mt19937_64 random(13);
    const auto pixels = test::true_corners(board, camera, truth);
    const auto corners = detect_board(board, test::render_board(printed, camera, truth, {}, random));
    EXPECT_EQ(corners.size(), 120u);
    for (const Corner& corner : corners)
      EXPECT_LT((corner.pixel - *pixels[static_cast<std::size_t>(corner.id)]).norm(), 0.5) << corner.id;
  }
}

TEST(Aprilgrid, IsNotFoundWhereItIsNot) {
  std::mt19937_64 random(3);
  const Camera camera = test::narrow_camera();
  const Pose pose = test::board_pose({0, 0, 1}, 1, 0.2, 1, 0);
  const Image other = test::render_board(test::make_board("checkerboard", 8, 6), camera, pose, {}, random);
  EXPECT_TRUE(detect_board(aprilgrid(6, 6), other).empty());
  EXPECT_TRUE(
      aprilgrid(6, 6).type->find(aprilgrid(6, 6), Image{8, 8, 1, 8, std::vector<std::uint8_t>(64)}).empty());
  EXPECT_TRUE(aprilgrid(6, 6).type->find(aprilgrid(6, 6), Image{}).empty());
}

}  // namespace
}  // namespace ca2
