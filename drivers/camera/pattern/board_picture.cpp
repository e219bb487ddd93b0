#include "drivers/camera/pattern/board_picture.h"

#include <Eigen/Dense>
#include <cmath>

namespace ca2 {
namespace {

constexpr float print = 30, paper = 210, wall = 110;
constexpr int samples = 8;  // per side of a pixel in which an edge runs

class BoardPainter {
 public:
  BoardPainter(const Board& board, const Camera& camera, const Pose& T_camera_board) : board_(board) {
    half_ = 0.5 * (board.type->pattern_size(board) + Eigen::Vector2d::Constant(board.square));
    const CameraParameters& k = camera.parameters;
    Eigen::Matrix3d K;
    K << k[0], 0, k[2], 0, k[1], k[3], 0, 0, 1;
    Eigen::Matrix3d plane;  // (x, y, 1) on the board to the camera's frame
    plane << T_camera_board.R.col(0), T_camera_board.R.col(1), T_camera_board.t;
    board_pixel_ = (K * plane).inverse();
  }

  float at(double u, double v) const {
    const Eigen::Vector3d h = board_pixel_ * Eigen::Vector3d(u, v, 1);
    const Eigen::Vector2d p = h.head<2>() / h.z();
    // Not (<) rather than (>=): what is no number is wall.
    if (!(h.z() > 0 && std::abs(p.x()) < half_.x() && std::abs(p.y()) < half_.y())) return wall;
    return board_.type->black(board_, p) ? print : paper;
  }

 private:
  const Board& board_;
  Eigen::Vector2d half_;         ///< m, of the sheet: the pattern and half a square of white
  Eigen::Matrix3d board_pixel_;  ///< pixel to board, homogeneous
};

}  // namespace

GreyImage board_picture(const Board& board, const Camera& camera, const Pose& T_camera_board) {
  const BoardPainter painter(board, camera, T_camera_board);
  GreyImage picture{camera.width, camera.height, {}};
  const std::size_t row = static_cast<std::size_t>(camera.width) + 1;
  // What is at the corners of the pixels: where all four agree the pixel is taken to be of one colour, as
  // squares and marker bits are several pixels wide.
  std::vector<float> above(row), below(row);
  const auto fill = [&](std::vector<float>& line, int y) {
    for (std::size_t x = 0; x < row; ++x) line[x] = painter.at(static_cast<double>(x) - 0.5, y - 0.5);
  };
  fill(above, 0);
  picture.pixels.reserve((row - 1) * static_cast<std::size_t>(camera.height));
  for (int y = 0; y < camera.height; ++y) {
    fill(below, y + 1);
    for (std::size_t x = 0; x + 1 < row; ++x) {
      float value = above[x];
      if (above[x + 1] != value || below[x] != value || below[x + 1] != value) {
        value = 0;
        for (int k = 0; k < samples * samples; ++k) {
          value += painter.at(static_cast<double>(x) - 0.5 + (k % samples + 0.5) / samples,
                              y - 0.5 + (k / samples + 0.5) / samples);
        }
        value /= samples * samples;
      }
      picture.pixels.push_back(value);
    }
    above.swap(below);
  }
  return picture;
}

}  // namespace ca2
