#include "core/board/detect/saddle_pyramid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/core/hal/intrin.hpp>
#include <span>

namespace ca2 {
namespace {

// Below, everything is noise: at sigma 1.2 px in all, a step of 10 grey values answers with 2.2.
constexpr double least_strength = 2.0;
// A board has fewer corners than this by far; the rest is room for texture that outshines it.
constexpr std::size_t most_peaks[] = {3500, 1800, 900};
constexpr std::size_t most_saddles[] = {1400, 700, 400};
constexpr double least_contrast = 10;  // grey values
constexpr double least_angle = 0.4;    // rad between edges: a square seen at 65 degrees of tilt has more

// The response is (64 Ixy)^2 - (64 Ixx)(64 Iyy) of grey values, times 2^-10, saturated: it fits 16 bits.
constexpr int response_shift = 10;

/// -det of the Hessian of one row, 0 in the 4 columns next to the rim.
void respond(const SaddleLevel& level, int y, std::int16_t* to) {
  const int w = level.width;
  const std::int16_t* above = level.smooth.data() + static_cast<std::size_t>(y - 1) * w;
  const std::int16_t* here = above + w;
  const std::int16_t* below = here + w;
  int x = 4;
  for (; x + 8 <= w - 4; x += 8) {
    const auto load = [x](const std::int16_t* row, int dx) { return cv::v_load(row + x + dx); };
    const cv::v_int16x8 twice = load(here, 0) << 1;
    const cv::v_int16x8 xx = (load(here, 1) + load(here, -1) - twice) << 2;
    const cv::v_int16x8 yy = (twice - load(above, 0) - load(below, 0)) << 2;  // negated
    const cv::v_int16x8 xy = (load(below, 1) - load(below, -1)) - (load(above, 1) - load(above, -1));
    cv::v_int16x8 a0, a1, b0, b1;
    cv::v_zip(xy, xx, a0, a1);
    cv::v_zip(xy, yy, b0, b1);
    cv::v_store(to + x,
                cv::v_pack(cv::v_dotprod(a0, b0) >> response_shift, cv::v_dotprod(a1, b1) >> response_shift));
  }
  for (; x < w - 4; ++x) {
    const int xx = 4 * (here[x + 1] + here[x - 1] - 2 * here[x]);
    const int yy = 4 * (2 * here[x] - above[x] - below[x]);
    const int xy = below[x + 1] - below[x - 1] - above[x + 1] + above[x - 1];
    to[x] = static_cast<std::int16_t>(std::clamp((xy * xy + xx * yy) >> response_shift, -32768, 32767));
  }
}

struct Peak {
  int value;
  int x;
  int y;
};

/// Is this the largest response of its 5 x 5 neighbourhood (the first in reading order among equals)?
bool is_peak(const std::int16_t* centre, int w) {
  const int value = *centre;
  for (int dy = -2; dy <= 2; ++dy) {
    const std::int16_t* row = centre + static_cast<std::ptrdiff_t>(dy) * w;
    for (int dx = -2; dx <= 2; ++dx) {
      const bool before = dy < 0 || (dy == 0 && dx < 0);
      if (before ? row[dx] >= value : row[dx] > value) return false;
    }
  }
  return true;
}

/// Which of the 8 responses from `at` on can be a peak above the threshold, as bits. Nearly always the first
/// comparisons say none, on texture too.
int peak_lanes(const std::int16_t* at, int w, const cv::v_int16x8& threshold) {
  const cv::v_int16x8 value = cv::v_load(at);
  cv::v_int16x8 peaks = value > threshold;
  if (!cv::v_check_any(peaks)) return 0;
  for (const int dy : {0, -1, 1, -2, 2}) {
    const std::int16_t* row = at + static_cast<std::ptrdiff_t>(dy) * w;
    peaks &= (value >= cv::v_load(row - 1)) & (value >= cv::v_load(row + 1));
    peaks &= (value >= cv::v_load(row - 2)) & (value >= cv::v_load(row + 2)) & (value >= cv::v_load(row));
    if (!cv::v_check_any(peaks)) return 0;
  }
  return cv::v_signmask(peaks);
}

/// The responses of a level, some rows at a time: all of them would be as large as the level, and be read
/// from memory again.
class ResponseRows {
 public:
  explicit ResponseRows(const SaddleLevel& level)
      : level_(level), w_(static_cast<std::size_t>(level.width)), rows_((at_once + 2 * beside) * w_, 0) {}

  /// Rows `first` to first + at_once, and two on each side; asked for from top to bottom, without a gap.
  void move_to(int first) {
    if (first > 4) std::copy_n(&rows_[at_once * w_], 2 * beside * w_, rows_.begin());
    for (int y = first > 4 ? first + beside : 4; y < first + at_once + beside; ++y) {
      std::int16_t* const to = &rows_[static_cast<std::size_t>(y - first + beside) * w_];
      if (y < level_.height - 4) {
        respond(level_, y, to);
      } else {
        std::fill_n(to, w_, std::int16_t{0});
      }
    }
    first_ = first;
  }
  const std::int16_t* row(int y) const { return &rows_[static_cast<std::size_t>(y - first_ + beside) * w_]; }

  static constexpr int at_once = 28;

 private:
  static constexpr int beside = 2;
  const SaddleLevel& level_;
  std::size_t w_;
  std::vector<std::int16_t> rows_;
  int first_ = 0;
};

std::vector<Peak> peaks_of(const SaddleLevel& level, std::size_t most) {
  const int w = level.width;
  const int h = level.height;
  std::vector<Peak> peaks;
  if (w < 16 || h < 16) return peaks;
  const auto least =
      static_cast<std::int16_t>(least_strength * least_strength * 4096 / (1 << response_shift));
  const cv::v_int16x8 threshold = cv::v_setall_s16(least);
  ResponseRows response(level);
  for (int y = 4; y < h - 4; ++y) {
    if ((y - 4) % ResponseRows::at_once == 0) response.move_to(y);
    const std::int16_t* row = response.row(y);
    for (int x = 4; x < w - 4; x += 8) {
      const int end = std::min(x + 8, w - 4);
      const unsigned lanes = end == x + 8 ? static_cast<unsigned>(peak_lanes(row + x, w, threshold)) : 0xffu;
      for (int k = x; k < end; ++k) {
        const bool possible = ((lanes >> (k - x)) & 1u) != 0;
        if (possible && row[k] > least && is_peak(row + k, w)) peaks.push_back({row[k], k, y});
      }
    }
  }
  const auto stronger = [](const Peak& a, const Peak& b) {
    return std::tie(b.value, a.y, a.x) < std::tie(a.value, b.y, b.x);
  };
  if (peaks.size() > most) {
    std::nth_element(peaks.begin(), peaks.begin() + static_cast<std::ptrdiff_t>(most), peaks.end(), stronger);
    peaks.resize(most);
  }
  std::sort(peaks.begin(), peaks.end(), stronger);
  return peaks;
}

/// The four ends of two crossing edges.
struct EdgeCross {
  Eigen::Vector2d e0;
  Eigen::Vector2d e1;
};

// Outside the blur as a rule; inside it where the squares are as small as that; between corner and marker.
constexpr double ring_radii[] = {4.0, 2.6, 1.8};
constexpr int ring_samples = 24;

/// Reads the edges off a circle round a saddle: it must be cut in four fields, opposite ones alike. (The
/// Hessian knows only the bisectors: blurred evenly, every cross has a Laplacian of zero in its middle.)
std::optional<EdgeCross> cross_on_ring(const SaddleLevel& level, const Eigen::Vector2d& p, double radius) {
  if (p.x() < radius + 1 || p.y() < radius + 1 || p.x() > level.width - radius - 2 ||
      p.y() > level.height - radius - 2) {
    return std::nullopt;
  }
  static const auto circle = [] {
    std::array<Eigen::Vector2f, ring_samples> points;
    for (int k = 0; k < ring_samples; ++k) {
      const double angle = 2 * M_PI * k / ring_samples;
      points[static_cast<std::size_t>(k)] = Eigen::Vector2d(std::cos(angle), std::sin(angle)).cast<float>();
    }
    return points;
  }();
  // Thousands of these on texture: single precision, and out again as soon as possible.
  const Eigen::Vector2f centre = p.cast<float>();
  const auto r = static_cast<float>(radius);
  std::array<float, ring_samples> grey;
  for (std::size_t k = 0; k < ring_samples; ++k) {
    grey[k] = level.interpolate(centre.x() + r * circle[k].x(), centre.y() + r * circle[k].y());
  }
  const auto [low, high] = std::minmax_element(grey.begin(), grey.end());
  const double contrast = *high - *low;
  const double middle = 0.5 * (*low + *high);
  if (contrast < least_contrast) return std::nullopt;
  // The middle of the cross is as far from the bright fields as from the dark ones.
  if (std::abs(level.interpolate(centre.x(), centre.y()) - middle) > 0.25 * contrast) return std::nullopt;
  double crossing[4];
  double extreme[4];  // of the field that ends at each crossing, from the middle
  int count = 0;
  double field = 0;
  const auto start = static_cast<std::size_t>(high - grey.begin());
  for (std::size_t n = 0; n < ring_samples; ++n) {
    const double here = grey[(start + n) % ring_samples] - middle;
    const double next = grey[(start + n + 1) % ring_samples] - middle;
    field = std::max(field, std::abs(here));
    if ((here > 0) == (next > 0)) continue;
    if (count == 4) return std::nullopt;
    crossing[count] = (static_cast<double>(start + n) + here / (here - next)) * 2 * M_PI / ring_samples;
    extreme[count] = field;
    field = 0;
    ++count;
  }
  if (count != 4) return std::nullopt;
  // The search began in the brightest sample: fields 0 and 2 are bright, the rest of 0 comes last.
  if (std::min(extreme[1], std::min(extreme[2], extreme[3])) < 0.2 * contrast) return std::nullopt;
  const double skew0 = crossing[2] - crossing[0] - M_PI;
  const double skew1 = crossing[3] - crossing[1] - M_PI;
  if (std::max(std::abs(skew0), std::abs(skew1)) > 0.6) return std::nullopt;
  const double angle0 = crossing[0] + 0.5 * skew0;
  const double angle1 = crossing[1] + 0.5 * skew1;
  if (angle1 - angle0 < least_angle || angle1 - angle0 > M_PI - least_angle) return std::nullopt;
  // From crossing 0 to 1 it is dark, so between -e0 and +e1 it is bright.
  return EdgeCross{{-std::cos(angle0), -std::sin(angle0)}, {std::cos(angle1), std::sin(angle1)}};
}

}  // namespace

std::optional<Saddle> saddle_near(const std::vector<SaddleLevel>& levels, int level,
                                  const Eigen::Vector2d& pixel, Rings rings) {
  const SaddleLevel& s = levels[static_cast<std::size_t>(level)];
  const Eigen::Vector2d start = s.to_level(pixel);
  if (!(std::abs(start.x()) < 1e6 && std::abs(start.y()) < 1e6)) return std::nullopt;
  int x = static_cast<int>(std::lround(start.x()));
  int y = static_cast<int>(std::lround(start.y()));
  for (int step = 0; step < 4; ++step) {
    if (x < 2 || y < 2 || x >= s.width - 2 || y >= s.height - 2) return std::nullopt;
    // The quadratic that fits the 3 x 3 pixels best.
    double v[3][3];
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 3; ++i) v[j][i] = s.at(x + i - 1, y + j - 1) / 16.0;
    }
    double gx = 0, gy = 0, xx = 0, yy = 0;
    for (int k = 0; k < 3; ++k) {
      gx += (v[k][2] - v[k][0]) / 6;
      gy += (v[2][k] - v[0][k]) / 6;
      xx += (v[k][2] - 2 * v[k][1] + v[k][0]) / 3;
      yy += (v[2][k] - 2 * v[1][k] + v[0][k]) / 3;
    }
    const double xy = (v[2][2] - v[2][0] - v[0][2] + v[0][0]) / 4;
    const double saddle = xy * xy - xx * yy;
    if (saddle <= 0.25 * least_strength * least_strength) return std::nullopt;
    const Eigen::Vector2d offset((yy * gx - xy * gy) / saddle, (xx * gy - xy * gx) / saddle);
    if (step < 3 && offset.cwiseAbs().maxCoeff() > 0.6) {
      // Away from the saddle the quadratic is only a hint: no leaps.
      x += static_cast<int>(std::lround(std::clamp(offset.x(), -1.0, 1.0)));
      y += static_cast<int>(std::lround(std::clamp(offset.y(), -1.0, 1.0)));
      continue;
    }
    if (offset.cwiseAbs().maxCoeff() > 1.0) return std::nullopt;
    const Eigen::Vector2d p = Eigen::Vector2d(x, y) + offset;
    if ((p - start).squaredNorm() > 4) return std::nullopt;
    for (const double radius : std::span(ring_radii).first(rings == Rings::small ? 3 : 2)) {
      if (const auto cross = cross_on_ring(s, p, radius)) {
        return Saddle{s.to_picture(p), cross->e0, cross->e1, std::sqrt(saddle), level};
      }
    }
    return std::nullopt;
  }
  return std::nullopt;
}

std::vector<Saddle> strongest_saddles(const std::vector<SaddleLevel>& levels, Rings rings) {
  std::vector<Saddle> saddles;
  // Marks the places taken, in cells of a level's pixels: a coarse level repeats what a finer one saw.
  for (int k = 0; k < static_cast<int>(levels.size()); ++k) {
    const SaddleLevel& level = levels[static_cast<std::size_t>(k)];
    std::vector<bool> taken(static_cast<std::size_t>(level.width) * static_cast<std::size_t>(level.height));
    const auto mark = [&](const Eigen::Vector2d& pixel, bool test) {
      const Eigen::Vector2d p = level.to_level(pixel);
      const int x = static_cast<int>(std::lround(p.x()));
      const int y = static_cast<int>(std::lround(p.y()));
      for (int j = std::max(0, y - 1); j <= std::min(level.height - 1, y + 1); ++j) {
        for (int i = std::max(0, x - 1); i <= std::min(level.width - 1, x + 1); ++i) {
          auto cell = taken[static_cast<std::size_t>(j) * level.width + i];
          if (test && cell) return false;
          if (!test) cell = true;
        }
      }
      return true;
    };
    for (const Saddle& saddle : saddles) mark(saddle.pixel, false);
    std::size_t count = 0;
    for (const Peak& peak : peaks_of(level, most_peaks[k])) {
      const auto saddle = saddle_near(levels, k, level.to_picture(Eigen::Vector2d(peak.x, peak.y)), rings);
      if (!saddle || !mark(saddle->pixel, true)) continue;
      mark(saddle->pixel, false);
      saddles.push_back(*saddle);
      if (++count == most_saddles[k]) break;
    }
  }
  std::stable_sort(saddles.begin(), saddles.end(),
                   [](const Saddle& a, const Saddle& b) { return a.strength > b.strength; });
  return saddles;
}

}  // namespace ca2
