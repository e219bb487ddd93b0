/// The print of a plate, pixel by pixel: its ink's exact share of every quarter-pixel cell, convolved there
/// with the pixel's square and the lens's Gaussian. At that spacing the Gaussian has nothing left to alias,
/// so that a corner in the picture is where the projection puts it.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "tools/sim/camera_simulator.h"

namespace ca2 {
namespace {

constexpr int fine = 4;  // cells per pixel and axis

/// The print as a function of the place inside one pixel: (0, 0) is its top-left corner, (1, 1) the other.
class PixelPrint {
 public:
  PixelPrint(const Board& board, const Eigen::Vector2d& p00, const Eigen::Vector2d& p10,
             const Eigen::Vector2d& p01, const Eigen::Vector2d& p11)
      : board_(board), p_(p00), du_(p10 - p00), dv_(p01 - p00), duv_(p11 - p10 - p01 + p00) {}

  bool ink(const Eigen::Vector2d& s) const {
    return board_.type->black(board_, p_ + s.x() * du_ + s.y() * dv_ + s.x() * s.y() * duv_);
  }

  /// Ink's share of the square at `corner`; `inks` are its corners, clockwise from the top left.
  double share(const Eigen::Vector2d& corner, double size, const std::array<bool, 4>& inks, int depth) const {
    const int count = inks[0] + inks[1] + inks[2] + inks[3];
    if (count == 0 || count == 4) return count / 4.0;
    const std::array<Eigen::Vector2d, 4> at{corner, corner + Eigen::Vector2d(size, 0),
                                            corner + Eigen::Vector2d(size, size),
                                            corner + Eigen::Vector2d(0, size)};
    if (!(count == 2 && inks[0] == inks[2])) {
      // One edge passes: the inked side of it is a polygon.
      std::array<Eigen::Vector2d, 5> polygon;
      std::array<Eigen::Vector2d, 2> crossings;
      std::size_t corners = 0, crossed = 0;
      for (std::size_t i = 0; i < 4; ++i) {
        const std::size_t next = (i + 1) % 4;
        if (inks[i]) polygon[corners++] = at[i];
        if (inks[i] == inks[next]) continue;
        crossings[crossed] = inks[i] ? crossing(at[i], at[next]) : crossing(at[next], at[i]);
        polygon[corners++] = crossings[crossed++];
      }
      if (straight(crossings, at, inks, size)) {
        double doubled = 0;
        for (std::size_t i = 0; i < corners; ++i) {
          const Eigen::Vector2d a = polygon[i] - corner, b = polygon[(i + 1) % corners] - corner;
          doubled += a.x() * b.y() - a.y() * b.x();
        }
        return std::abs(doubled) / (2 * size * size);
      }
    }
    // A corner of the print: quarters, down to a sixty-fourth of a pixel.
    constexpr int max_depth = 4;
    if (depth == max_depth) return count / 4.0;
    const double half = size / 2;
    const bool top = ink(corner + Eigen::Vector2d(half, 0)),
               right = ink(corner + Eigen::Vector2d(size, half));
    const bool bottom = ink(corner + Eigen::Vector2d(half, size)),
               left = ink(corner + Eigen::Vector2d(0, half));
    const bool middle = ink(corner + Eigen::Vector2d(half, half));
    return (share(corner, half, {inks[0], top, middle, left}, depth + 1) +
            share(corner + Eigen::Vector2d(half, 0), half, {top, inks[1], right, middle}, depth + 1) +
            share(corner + Eigen::Vector2d(half, half), half, {middle, right, inks[2], bottom}, depth + 1) +
            share(corner + Eigen::Vector2d(0, half), half, {left, middle, bottom, inks[3]}, depth + 1)) /
           4;
  }

 private:
  /// Where the ink ends between an inked and a bare place.
  Eigen::Vector2d crossing(Eigen::Vector2d inked, Eigen::Vector2d bare) const {
    for (int i = 0; i < 11; ++i) {
      const Eigen::Vector2d middle = (inked + bare) / 2;
      (ink(middle) ? inked : bare) = middle;
    }
    return (inked + bare) / 2;
  }

  /// Is the ink's rim straight between the crossings? Asked a little to both sides of the chord's middle.
  bool straight(const std::array<Eigen::Vector2d, 2>& crossings, const std::array<Eigen::Vector2d, 4>& at,
                const std::array<bool, 4>& inks, double size) const {
    const Eigen::Vector2d chord = crossings[1] - crossings[0];
    const Eigen::Vector2d middle = (crossings[0] + crossings[1]) / 2;
    Eigen::Vector2d aside(-chord.y(), chord.x());
    if (aside.norm() < 0.02 * size) return true;
    aside *= 0.03 * size / aside.norm();
    for (std::size_t i = 0; i < 4; ++i) {
      if (inks[i]) {
        if (aside.dot(at[i] - middle) < 0) aside = -aside;
        break;
      }
    }
    return ink(middle + aside) && !ink(middle - aside);
  }

  const Board& board_;
  Eigen::Vector2d p_, du_, dv_, duv_;
};

struct Region {
  int x = 0, y = 0, width = 0, height = 0;  ///< px
};

/// The part of the picture that the pattern's ink can reach, blur included.
Region reached(const Camera& camera, const Pose& T_camera_plate, const Solid& solid, double blur) {
  const Eigen::Vector2d size = solid.print->type->pattern_size(*solid.print);
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::max()), high = -low;
  constexpr int steps = 24;  // along each side: a fisheye bends them
  for (int i = 0; i <= steps; ++i) {
    for (int j = 0; j <= steps; ++j) {
      const Eigen::Vector2d p(size.x() * (static_cast<double>(i) / steps - 0.5),
                              size.y() * (static_cast<double>(j) / steps - 0.5));
      const auto pixel =
          camera.project(T_camera_plate * Eigen::Vector3d(p.x(), p.y(), solid.plate.height(p)));
      if (!pixel) continue;
      low = low.cwiseMin(*pixel);
      high = high.cwiseMax(*pixel);
    }
  }
  const double margin = std::ceil(4 * blur) + 3;
  const int x0 = static_cast<int>(std::clamp(low.x() - margin, 0.0, static_cast<double>(camera.width)));
  const int y0 = static_cast<int>(std::clamp(low.y() - margin, 0.0, static_cast<double>(camera.height)));
  const int x1 = static_cast<int>(std::clamp(high.x() + margin, 0.0, static_cast<double>(camera.width)));
  const int y1 = static_cast<int>(std::clamp(high.y() + margin, 0.0, static_cast<double>(camera.height)));
  return {x0, y0, std::max(0, x1 - x0), std::max(0, y1 - y0)};
}

/// Weights of the cells from `-reach` to `fine - 1 + reach` (0: the first of the pixel): the pixel's square
/// is the mean of its cells, the Gaussian is sampled at the cells' spacing.
struct FineKernel {
  int reach = 0;
  std::vector<float> weights;

  explicit FineKernel(double blur) {
    const double sigma = blur * fine;
    reach = static_cast<int>(std::ceil(4 * sigma));
    std::vector<double> gauss(static_cast<std::size_t>(2 * reach + 1));
    double sum = 0;
    for (int k = -reach; k <= reach; ++k) {
      sum += gauss[static_cast<std::size_t>(k + reach)] =
          k == 0 ? 1 : std::exp(-0.5 * k * k / (sigma * sigma));
    }
    weights.assign(static_cast<std::size_t>(2 * reach + fine), 0);
    for (int k = 0; k <= 2 * reach; ++k) {
      for (int j = 0; j < fine; ++j) {
        weights[static_cast<std::size_t>(k + j)] +=
            static_cast<float>(gauss[static_cast<std::size_t>(k)] / sum / fine);
      }
    }
  }
};

/// The lattice of pixel corners over a region: where each lies on the plate, and whether there is ink.
class CornerLattice {
 public:
  CornerLattice(const RayGrid& rays, const Pose& T_camera_plate, const Solid& solid, const Region& region)
      : columns_(region.width + 1) {
    const Pose T_plate_camera = T_camera_plate.inverse();
    std::vector<Eigen::Vector3d> directions;
    for (int j = 0; j <= region.height; ++j) {
      rays.row(region.x - 0.5, columns_, region.y + j - 0.5, directions);
      for (const Eigen::Vector3d& d : directions) {
        const Eigen::Vector3d direction = T_plate_camera.R * d;
        const auto t = solid.plate.meet(T_plate_camera.t, direction);
        // Where no ray is, there is no print either: far outside the pattern.
        const bool met = t && *t > 0;
        p_.push_back(met ? Eigen::Vector2d((T_plate_camera.t + *t * direction).head<2>())
                         : Eigen::Vector2d::Constant(1e3));
        ink_.push_back(solid.print->type->black(*solid.print, p_.back()) ? 1 : 0);
      }
    }
    rows_ = region.height + 1;
  }

  const Eigen::Vector2d& p(int x, int y) const { return p_[static_cast<std::size_t>(y) * columns_ + x]; }
  bool ink(int x, int y) const { return ink_[static_cast<std::size_t>(y) * columns_ + x] != 0; }

  /// Do the corners of the pixel and of its neighbours all agree?
  bool uniform(int x, int y) const {
    const bool first = ink(x, y);
    for (int b = std::max(0, y - 1); b <= std::min(rows_ - 1, y + 2); ++b) {
      for (int a = std::max(0, x - 1); a <= std::min(columns_ - 1, x + 2); ++a) {
        if (ink(a, b) != first) return false;
      }
    }
    return true;
  }

 private:
  int columns_ = 0, rows_ = 0;
  std::vector<Eigen::Vector2d> p_;
  std::vector<char> ink_;
};

/// Ink's share of the 4 x 4 cells of a pixel.
std::array<float, fine * fine> cell_shares(const Board& board, const CornerLattice& lattice, int x, int y) {
  std::array<float, fine * fine> shares;
  if (lattice.uniform(x, y)) {
    shares.fill(lattice.ink(x, y) ? 1.0f : 0.0f);
    return shares;
  }
  const PixelPrint print(board, lattice.p(x, y), lattice.p(x + 1, y), lattice.p(x, y + 1),
                         lattice.p(x + 1, y + 1));
  std::array<bool, (fine + 1) * (fine + 1)> inks;
  constexpr double size = 1.0 / fine;
  for (std::size_t j = 0; j <= fine; ++j) {
    for (std::size_t i = 0; i <= fine; ++i) {
      inks[j * (fine + 1) + i] = print.ink({static_cast<double>(i) * size, static_cast<double>(j) * size});
    }
  }
  for (std::size_t j = 0; j < fine; ++j) {
    for (std::size_t i = 0; i < fine; ++i) {
      const std::size_t k = j * (fine + 1) + i;
      shares[j * fine + i] =
          static_cast<float>(print.share({static_cast<double>(i) * size, static_cast<double>(j) * size}, size,
                                         {inks[k], inks[k + 1], inks[k + fine + 2], inks[k + fine + 1]}, 0));
    }
  }
  return shares;
}

}  // namespace

void subtract_print(const RayGrid& rays, const Pose& T_camera_plate, const Solid& solid, double blur,
                    const std::vector<float>& plate_light, std::vector<float>& radiance) {
  const Region region = reached(rays.camera(), T_camera_plate, solid, blur);
  if (region.width == 0 || region.height == 0) return;
  const auto width = static_cast<std::size_t>(region.width);
  const CornerLattice lattice(rays, T_camera_plate, solid, region);
  const FineKernel kernel(blur);
  const auto picture_index = [&](int x, int y) {
    return static_cast<std::size_t>(region.y + y) * rays.camera().width + region.x + x;
  };

  // Along the rows first, at once down to pixels, so that only a quarter of the cells is ever stored.
  const auto pad = static_cast<std::size_t>(kernel.reach);
  std::vector<float> columns(static_cast<std::size_t>(region.height) * fine * width);
  std::array<std::vector<float>, fine> lines;
  for (int y = 0; y < region.height; ++y) {
    for (auto& line : lines) line.assign(width * fine + 2 * pad, 0);
    for (int x = 0; x < region.width; ++x) {
      const float light = plate_light[picture_index(x, y)];
      if (light == 0) continue;
      const auto shares = cell_shares(*solid.print, lattice, x, y);
      for (std::size_t k = 0; k < shares.size(); ++k) {
        lines[k / fine][pad + static_cast<std::size_t>(x) * fine + k % fine] = light * shares[k];
      }
    }
    for (std::size_t j = 0; j < fine; ++j) {
      float* out = columns.data() + (static_cast<std::size_t>(y) * fine + j) * width;
      for (std::size_t x = 0; x < width; ++x) {
        const float* in = lines[j].data() + x * fine;
        float sum = 0;
        for (std::size_t k = 0; k < kernel.weights.size(); ++k) sum += kernel.weights[k] * in[k];
        out[x] = sum;
      }
    }
  }
  const auto contrast = static_cast<float>(paper_albedo - ink_albedo);
  std::vector<float> row(width);
  for (int y = 0; y < region.height; ++y) {
    std::fill(row.begin(), row.end(), 0.0f);
    for (int k = 0; k < static_cast<int>(kernel.weights.size()); ++k) {
      const int from = y * fine + k - kernel.reach;
      if (from < 0 || from >= region.height * fine) continue;
      const float* in = columns.data() + static_cast<std::size_t>(from) * width;
      for (std::size_t x = 0; x < width; ++x) row[x] += kernel.weights[static_cast<std::size_t>(k)] * in[x];
    }
    for (int x = 0; x < region.width; ++x) {
      radiance[picture_index(x, y)] -= contrast * row[static_cast<std::size_t>(x)];
    }
  }
}

}  // namespace ca2
