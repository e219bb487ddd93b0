/// @file Pictures of boards with known corners, for tests: exact geometry through any camera, the pixel's
/// area and a Gaussian blur integrated, then noise and 8 bits.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "core/board/board.h"

namespace ca2::test {

struct RenderOptions {
  double sigma = 0.7;       ///< px, blur of the lens on top of the pixel's area
  double noise = 1.8;       ///< grey levels
  double black = 30;        ///< grey of the print
  double white = 210;       ///< grey of the paper
  double background = 110;  ///< grey of what is behind
  double margin = 0.02;     ///< m of paper round the pattern
};

/// What the board shows at a point of its plane: print, paper, or nothing (background).
inline double board_grey(const Board& board, const Eigen::Vector2d& p, const RenderOptions& o) {
  const Eigen::Vector2d half = 0.5 * board.type->pattern_size(board) + Eigen::Vector2d::Constant(o.margin);
  if (std::abs(p.x()) > half.x() || std::abs(p.y()) > half.y()) return o.background;
  return board.type->black(board, p) ? o.black : o.white;
}

/// A row-major patch of grey values in floating point.
struct Patch {
  int x = 0, y = 0, width = 0, height = 0;
  std::vector<double> grey;

  double at(int px, int py) const { return grey[static_cast<std::size_t>(py - y) * width + (px - x)]; }
};

/// The board's part of the picture without noise. Every pixel is cut in 4 x 4 cells; a cell across an edge in
/// 8 x 8 jittered samples; the cells are blurred and summed.
inline Patch render_patch(const Board& board, const Camera& camera, const Pose& T_camera_board,
                          const RenderOptions& o, std::mt19937_64& random) {
  constexpr int fine = 4;
  Eigen::Vector2d low(1e9, 1e9), high(-1e9, -1e9);
  const Eigen::Vector2d half = 0.5 * board.type->pattern_size(board) + Eigen::Vector2d::Constant(o.margin);
  for (double u = -1; u <= 1; u += 0.05) {
    for (const Eigen::Vector2d& e :
         {Eigen::Vector2d(u, -1), Eigen::Vector2d(u, 1), Eigen::Vector2d(-1, u), Eigen::Vector2d(1, u)}) {
      const auto pixel =
          camera.project(T_camera_board * Eigen::Vector3d(e.x() * half.x(), e.y() * half.y(), 0));
      if (!pixel) continue;
      low = low.cwiseMin(*pixel);
      high = high.cwiseMax(*pixel);
    }
  }
  const int margin = static_cast<int>(std::ceil(4 * o.sigma)) + 2;
  Patch patch;
  patch.x = std::max(0, static_cast<int>(low.x()) - margin);
  patch.y = std::max(0, static_cast<int>(low.y()) - margin);
  patch.width = std::min(camera.width - 1, static_cast<int>(high.x()) + margin) - patch.x + 1;
  patch.height = std::min(camera.height - 1, static_cast<int>(high.y()) + margin) - patch.y + 1;
  if (patch.width <= 0 || patch.height <= 0) return {};

  // Where the rays through the pixels' corners meet the board; in between, linear in homogeneous coordinates.
  const Pose T_board_camera = T_camera_board.inverse();
  const int gw = patch.width + 1;
  std::vector<Eigen::Vector3d> ray(static_cast<std::size_t>(gw) * (patch.height + 1),
                                   Eigen::Vector3d::Zero());
  for (int j = 0; j <= patch.height; ++j) {
    for (int i = 0; i < gw; ++i) {
      const auto bearing = camera.unproject(Eigen::Vector2d(patch.x + i - 0.5, patch.y + j - 0.5));
      if (bearing) ray[static_cast<std::size_t>(j) * gw + i] = T_board_camera.R * *bearing;
    }
  }
  const Eigen::Vector3d& eye = T_board_camera.t;
  const auto grey_at = [&](double u, double v) {  // pixels of the patch from its corner
    const int i = std::min(static_cast<int>(u), patch.width - 1);
    const int j = std::min(static_cast<int>(v), patch.height - 1);
    const double a = u - i, b = v - j;
    const Eigen::Vector3d* r = &ray[static_cast<std::size_t>(j) * gw + i];
    const Eigen::Vector3d d = (1 - b) * ((1 - a) * r[0] + a * r[1]) + b * ((1 - a) * r[gw] + a * r[gw + 1]);
    if (eye.z() * d.z() >= 0) return o.background;
    const double t = -eye.z() / d.z();
    return board_grey(board, Eigen::Vector2d(eye.x() + t * d.x(), eye.y() + t * d.y()), o);
  };
  const int w = patch.width * fine;
  const int h = patch.height * fine;
  std::vector<double> corner(static_cast<std::size_t>(w + 1) * (h + 1));
  for (int j = 0; j <= h; ++j) {
    for (int i = 0; i <= w; ++i) {
      corner[static_cast<std::size_t>(j) * (w + 1) + i] =
          grey_at(static_cast<double>(i) / fine, static_cast<double>(j) / fine);
    }
  }
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<double> cell(static_cast<std::size_t>(w) * h);
  for (int j = 0; j < h; ++j) {
    for (int i = 0; i < w; ++i) {
      const double* c = &corner[static_cast<std::size_t>(j) * (w + 1) + i];
      double value = c[0];
      if (c[1] != value || c[w + 1] != value || c[w + 2] != value) {
        value = 0;
        for (int k = 0; k < 64; ++k) {
          value +=
              grey_at((i + (k % 8 + unit(random)) / 8) / fine, (j + (k / 8 + unit(random)) / 8) / fine) / 64;
        }
      }
      cell[static_cast<std::size_t>(j) * w + i] = value;
    }
  }
  // Separable blur on the fine grid; its rim repeats.
  std::vector<double> kernel;
  const int radius = static_cast<int>(std::ceil(4.5 * o.sigma * fine));
  double sum = 0;
  for (int k = -radius; k <= radius; ++k) {
    kernel.push_back(o.sigma > 0 ? std::exp(-0.5 * k * k / (o.sigma * o.sigma * fine * fine)) : 1);
    sum += kernel.back();
  }
  std::vector<double> blurred(cell.size());
  for (int j = 0; j < h; ++j) {
    for (int i = 0; i < w; ++i) {
      double value = 0;
      for (int k = -radius; k <= radius; ++k) {
        value += kernel[static_cast<std::size_t>(k + radius)] *
                 cell[static_cast<std::size_t>(j) * w + std::clamp(i + k, 0, w - 1)];
      }
      blurred[static_cast<std::size_t>(j) * w + i] = value / sum;
    }
  }
  patch.grey.assign(static_cast<std::size_t>(patch.width) * patch.height, 0);
  for (int j = 0; j < h; ++j) {
    for (int k = -radius; k <= radius; ++k) {
      const double weight = kernel[static_cast<std::size_t>(k + radius)] / sum / (fine * fine);
      const double* from = &blurred[static_cast<std::size_t>(std::clamp(j + k, 0, h - 1)) * w];
      double* to = &patch.grey[static_cast<std::size_t>(j / fine) * patch.width];
      for (int i = 0; i < w; ++i) to[i / fine] += weight * from[i];
    }
  }
  return patch;
}

/// The whole picture at 8 bits, with noise everywhere.
inline Image finish(const Camera& camera, const Patch& patch, const RenderOptions& o,
                    std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  Image image{camera.width, camera.height, 1, 8, {}};
  image.bytes.resize(static_cast<std::size_t>(image.width) * image.height);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const int i = x - patch.x, j = y - patch.y;
      const bool inside = i >= 0 && j >= 0 && i < patch.width && j < patch.height;
      const double grey =
          (inside ? patch.grey[static_cast<std::size_t>(j) * patch.width + i] : o.background) +
          o.noise * normal(random);
      image.bytes[static_cast<std::size_t>(y) * image.width + x] =
          static_cast<std::uint8_t>(std::clamp(std::lround(grey), 0L, 255L));
    }
  }
  return image;
}

inline Image render_board(const Board& board, const Camera& camera, const Pose& T_camera_board,
                          const RenderOptions& o, std::mt19937_64& random) {
  return finish(camera, render_patch(board, camera, T_camera_board, o, random), o, random);
}

/// Corner pixels by id; nothing where the camera does not see one.
inline std::vector<std::optional<Eigen::Vector2d>> true_corners(const Board& board, const Camera& camera,
                                                                const Pose& T_camera_board) {
  std::vector<std::optional<Eigen::Vector2d>> pixels;
  for (const Eigen::Vector2d& p : board.type->corners(board)) {
    pixels.push_back(camera.project(T_camera_board * Eigen::Vector3d(p.x(), p.y(), 0)));
  }
  return pixels;
}

}  // namespace ca2::test
