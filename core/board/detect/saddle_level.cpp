#include "core/board/detect/saddle_level.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/core/hal/intrin.hpp>

namespace ca2 {
namespace {

// Smoothing reaches 2 px, the response 4 px of the rim are without, a peak needs 2 px round it.
constexpr int window_margin = 8;

Image halved(const Image& image) {
  Image half{image.width / 2, image.height / 2, 1, 8, {}};
  half.bytes.resize(static_cast<std::size_t>(half.width) * static_cast<std::size_t>(half.height));
  for (int y = 0; y < half.height; ++y) {
    const std::uint8_t* a = image.bytes.data() + static_cast<std::size_t>(2 * y) * image.width;
    const std::uint8_t* b = a + image.width;
    std::uint8_t* to = half.bytes.data() + static_cast<std::size_t>(y) * half.width;
    int x = 0;
    for (; x + 16 <= half.width; x += 16) {
      cv::v_uint8x16 a0, a1, b0, b1;
      cv::v_load_deinterleave(a + 2 * x, a0, a1);
      cv::v_load_deinterleave(b + 2 * x, b0, b1);
      cv::v_uint16x8 low, high, sum_low, sum_high;
      cv::v_expand(a0, sum_low, sum_high);
      for (const cv::v_uint8x16& part : {a1, b0, b1}) {
        cv::v_expand(part, low, high);
        sum_low += low;
        sum_high += high;
      }
      cv::v_store(to + x, cv::v_rshr_pack<2>(sum_low, sum_high));
    }
    for (; x < half.width; ++x) {
      to[x] = static_cast<std::uint8_t>((a[2 * x] + a[2 * x + 1] + b[2 * x] + b[2 * x + 1] + 2) >> 2);
    }
  }
  return half;
}

/// Binomial 1 4 6 4 1 in both directions; the rim is repeated.
SaddleLevel smoothed(const Image& image, double scale) {
  const int w = image.width;
  const int h = image.height;
  SaddleLevel level{w, h, scale, {}, {0, 0}};
  level.smooth.resize(static_cast<std::size_t>(w) * static_cast<std::size_t>(h));
  std::vector<std::uint16_t> column(static_cast<std::size_t>(w) + 4);
  for (int y = 0; y < h; ++y) {
    const std::uint8_t* row[5];
    for (int k = 0; k < 5; ++k) {
      row[k] = image.bytes.data() + static_cast<std::size_t>(std::clamp(y + k - 2, 0, h - 1)) * w;
    }
    int x = 0;
    for (; x + 8 <= w; x += 8) {
      const cv::v_uint16x8 middle = cv::v_load_expand(row[2] + x);
      const cv::v_uint16x8 near = cv::v_load_expand(row[1] + x) + cv::v_load_expand(row[3] + x);
      const cv::v_uint16x8 far = cv::v_load_expand(row[0] + x) + cv::v_load_expand(row[4] + x);
      const cv::v_uint16x8 sum = far + (near << 2) + (middle << 2) + (middle << 1);
      cv::v_store(column.data() + 2 + x, sum);
    }
    for (; x < w; ++x) {
      column[static_cast<std::size_t>(x) + 2] =
          static_cast<std::uint16_t>(row[0][x] + row[4][x] + 4 * (row[1][x] + row[3][x]) + 6 * row[2][x]);
    }
    column[0] = column[1] = column[2];
    column[static_cast<std::size_t>(w) + 3] = column[static_cast<std::size_t>(w) + 2] =
        column[static_cast<std::size_t>(w) + 1];
    std::int16_t* to = level.smooth.data() + static_cast<std::size_t>(y) * w;
    const std::uint16_t* c = column.data();
    for (x = 0; x + 8 <= w; x += 8) {
      const cv::v_uint16x8 middle = cv::v_load(c + x + 2);
      const cv::v_uint16x8 near = cv::v_load(c + x + 1) + cv::v_load(c + x + 3);
      const cv::v_uint16x8 far = cv::v_load(c + x) + cv::v_load(c + x + 4);
      const cv::v_uint16x8 sum = far + (near << 2) + (middle << 2) + (middle << 1);
      cv::v_store(to + x, cv::v_reinterpret_as_s16(sum >> 4));
    }
    for (; x < w; ++x) {
      const int sum = c[x] + c[x + 4] + 4 * (c[x + 1] + c[x + 3]) + 6 * c[x + 2];
      to[x] = static_cast<std::int16_t>(sum >> 4);
    }
  }
  return level;
}

}  // namespace

double SaddleLevel::grey(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d p = to_level(pixel);
  return interpolate(static_cast<float>(std::clamp(p.x(), 0.0, width - 1.001)),
                     static_cast<float>(std::clamp(p.y(), 0.0, height - 1.001)));
}

std::vector<SaddleLevel> saddle_levels(const Image& grey8) {
  std::vector<SaddleLevel> levels;
  Image image;
  for (int k = 0; k < saddle_level_count; ++k) {
    if (k > 0) image = halved(k == 1 ? grey8 : image);
    levels.push_back(smoothed(k == 0 ? grey8 : image, 1 << k));
  }
  return levels;
}

SaddleLevel saddle_window(const Image& grey8, int level, const Eigen::Vector2d& pixel, int radius) {
  const int step = 1 << level;
  const SaddleLevel whole{grey8.width / step, grey8.height / step, static_cast<double>(step), {}, {0, 0}};
  const Eigen::Vector2d centre = whole.to_level(pixel);
  const int reach = radius + window_margin;
  if (!(centre.cwiseAbs().maxCoeff() < 1e6)) return {};
  const int x0 = std::max(0, static_cast<int>(std::lround(centre.x())) - reach);
  const int y0 = std::max(0, static_cast<int>(std::lround(centre.y())) - reach);
  const int x1 = std::min(whole.width, static_cast<int>(std::lround(centre.x())) + reach + 1);
  const int y1 = std::min(whole.height, static_cast<int>(std::lround(centre.y())) + reach + 1);
  if (x1 <= x0 || y1 <= y0) return {};
  Image part{(x1 - x0) * step, (y1 - y0) * step, 1, 8, {}};
  part.bytes.resize(static_cast<std::size_t>(part.width) * static_cast<std::size_t>(part.height));
  for (int y = 0; y < part.height; ++y) {
    const auto from = static_cast<std::size_t>(y0 * step + y) * grey8.width + x0 * step;
    std::copy_n(grey8.bytes.begin() + static_cast<std::ptrdiff_t>(from), part.width,
                part.bytes.begin() + static_cast<std::ptrdiff_t>(y) * part.width);
  }
  for (int k = 0; k < level; ++k) part = halved(part);
  SaddleLevel window = smoothed(part, step);
  window.origin = {x0 * step, y0 * step};
  return window;
}

}  // namespace ca2
