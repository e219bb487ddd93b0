#include "core/board/refine/refine_corners.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "core/board/refine/edge_profile.h"
#include "core/board/refine/neighbourhood.h"
#include "core/board/refine/saddle_fit.h"

namespace ca2 {
namespace {

// A patch reaches half-way to the next corner: no pixel is used twice.
constexpr double reach_share = 0.5;
constexpr double most_reach = 24;         // px, bounds the time on large squares
constexpr double rough_reach = 12;        // px along the edges, in the first pass
constexpr double rough_tolerance = 1e-2;  // px
constexpr double model_floor = 0.002;     // px, what lens, print and paper do that the model does not know
constexpr double quantisation = 0.083;    // grey^2, of 8 bits: 1/12

/// Which places round a corner, in units of the pitch from -1/2 to 1/2, show what a plain chessboard would,
/// also a blur's width away.
class PrintMask {
 public:
  static constexpr int cells = 32;

  PrintMask(const Board& board, const Eigen::Vector2d& corner, double pitch) {
    if (board.type->repeats(board)) return;  // a print like that has nothing beside its corners
    // A quadrant's own colour is that next to the corner.
    bool black[2][2];
    for (const int j : {0, 1}) {
      for (const int i : {0, 1}) {
        const Eigen::Vector2d near(i == 0 ? -0.01 : 0.01, j == 0 ? -0.01 : 0.01);
        black[j][i] = board.type->black(board, corner + near * pitch);
      }
    }
    for (int j = 0; j < cells; ++j) {
      std::uint16_t in_row = 0;
      for (int i = 0; i < cells; ++i) {
        const Eigen::Vector2d at((i + 0.5) / cells - 0.5, (j + 0.5) / cells - 0.5);
        const bool plain =
            board.type->black(board, corner + at * pitch) == black[2 * j / cells][2 * i / cells];
        in_row = static_cast<std::uint16_t>(in_row + (plain ? 0 : 1));
        other(j + 1, i + 1) = static_cast<std::uint16_t>(other(j, i + 1) + in_row);
      }
    }
    all_ = other(cells, cells) == 0;
  }

  /// `margin` in units of the pitch along each axis.
  bool plain(const Eigen::Vector2d& at, const Eigen::Vector2d& margin) const {
    if (all_) return true;
    const auto cell = [](double u) {
      return std::clamp(static_cast<int>(std::floor((u + 0.5) * cells)), 0, cells - 1);
    };
    const int top = cell(at.y() - margin.y()), bottom = cell(at.y() + margin.y()) + 1;
    const int left = cell(at.x() - margin.x()), right = cell(at.x() + margin.x()) + 1;
    return other(bottom, right) - other(top, right) == other(bottom, left) - other(top, left);
  }

 private:
  /// How many of the cells above and to the left are not plain.
  std::uint16_t& other(int row, int column) {
    return sums_[static_cast<std::size_t>(row * (cells + 1) + column)];
  }
  std::uint16_t other(int row, int column) const {
    return sums_[static_cast<std::size_t>(row * (cells + 1) + column)];
  }

  std::array<std::uint16_t, static_cast<std::size_t>((cells + 1) * (cells + 1))> sums_{};
  bool all_ = true;
};

/// The pixels of a corner's patch. Edges are followed for `edge_reach` px.
CornerPatch cut_patch(const GreyView& image, const Eigen::Vector2d& centre, const Neighbourhood& lattice,
                      const PrintMask& mask, double sigma, double edge_reach) {
  Eigen::Matrix2d pixel_by_board;
  pixel_by_board << lattice.along[0], lattice.along[1];
  const Eigen::Matrix2d board_by_pixel = pixel_by_board.inverse();
  double part[2], edge_band[2];
  for (int i = 0; i < 2; ++i) {
    const double length = lattice.along[i].norm();
    part[i] = std::min(reach_share * lattice.reach[i], most_reach) / length;
    // Pitches per pixel across the lines of the other axis.
    edge_band[i] = (2.7 * sigma + 0.8) * board_by_pixel.row(i).norm();
  }
  const Eigen::Vector2d margin(0.7 * (sigma + 0.5) * board_by_pixel.row(0).norm(),
                               0.7 * (sigma + 0.5) * board_by_pixel.row(1).norm());
  const Eigen::Vector2d half = part[0] * lattice.along[0].cwiseAbs() + part[1] * lattice.along[1].cwiseAbs();
  const int x0 = std::max(0, static_cast<int>(std::ceil(centre.x() - half.x())));
  const int x1 = std::min(image.width() - 1, static_cast<int>(std::floor(centre.x() + half.x())));
  const int y0 = std::max(0, static_cast<int>(std::ceil(centre.y() - half.y())));
  const int y1 = std::min(image.height() - 1, static_cast<int>(std::floor(centre.y() + half.y())));
  CornerPatch patch{centre, {}, {}};
  patch.edge.reserve(512);
  // Of the flat pixels of a large patch one in `thin` each way: 24 x 24 are enough.
  const int thin = std::max(1, static_cast<int>(half.maxCoeff() / 12));
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) {
      const Eigen::Vector2d off = Eigen::Vector2d(x, y) - centre;
      const Eigen::Vector2d at = board_by_pixel * off;
      if (std::abs(at.x()) > part[0] || std::abs(at.y()) > part[1]) continue;
      const bool flat = std::abs(at.x()) > edge_band[0] && std::abs(at.y()) > edge_band[1];
      if (flat ? x % thin != 0 || y % thin != 0 : off.squaredNorm() > edge_reach * edge_reach) continue;
      if (!mask.plain(at, margin)) continue;
      if (flat) {
        patch.flat.add(at.x() * at.y() < 0 ? 1 : -1, off.x(), off.y(), image.at(x, y));
      } else {
        patch.edge.push_back({static_cast<double>(x), static_cast<double>(y), image.at(x, y)});
      }
    }
  }
  return patch;
}

/// Blur of the picture near a corner from the steepest descent towards a neighbouring field, px: a start.
double guess_sigma(const GreyView& image, const Eigen::Vector2d& centre, const Neighbourhood& lattice) {
  // Across the middle of an edge the profile is the plain blurred step: its extent over its steepest slope.
  const Eigen::Vector2d middle = centre + 0.3 * lattice.along[0];
  const Eigen::Vector2d step = 0.35 * lattice.along[1];
  const int samples = std::clamp(static_cast<int>(std::ceil(4 * step.norm())), 8, 200);
  double low = 1e9, high = -1e9, slope = 0, last = 0;
  for (int k = 0; k <= samples; ++k) {
    const Eigen::Vector2d p = middle + (2.0 * k / samples - 1) * step;
    const int x = static_cast<int>(std::floor(p.x()));
    const int y = static_cast<int>(std::floor(p.y()));
    if (x < 0 || y < 0 || x + 1 >= image.width() || y + 1 >= image.height()) return 1;
    const double a = p.x() - x, b = p.y() - y;
    const double grey = (1 - b) * ((1 - a) * image.at(x, y) + a * image.at(x + 1, y)) +
                        b * ((1 - a) * image.at(x, y + 1) + a * image.at(x + 1, y + 1));
    if (k > 0) slope = std::max(slope, std::abs(grey - last));
    last = grey;
    low = std::min(low, grey);
    high = std::max(high, grey);
  }
  const double per_px = slope / (2 * step.norm() / samples);
  return per_px > 0 ? std::clamp((high - low) / per_px / std::sqrt(2 * M_PI), 0.3, 8.0) : 1;
}

/// Beyond the rim a crossing is only guessed from what its edges do before it.
bool in_picture(const GreyView& image, const Eigen::Vector2d& pixel) {
  return pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() <= image.width() - 1 &&
         pixel.y() <= image.height() - 1;
}

/// A patch that hardly shows the crossing gives sums whose inverse is none: not even positive, with rounding.
bool is_usable(const Eigen::Matrix2d& covariance) {
  return covariance.allFinite() && covariance.trace() < 1 && covariance(0, 0) > 0 &&
         covariance.determinant() > 0;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

struct Refined {
  Corner corner;
  SaddleFit fit;
};

double typical_rms(const std::vector<Refined>& refined) {
  std::vector<double> rms;
  for (const Refined& r : refined) rms.push_back(r.fit.rms);
  return median(rms);
}

/// The usual blur of each of the board's two directions of edges, px.
void pool_blur(const std::vector<Refined>& refined, std::vector<SaddlePrior>& priors) {
  constexpr double least = 0.05;  // px: less looks the same
  constexpr double weight = 20;   // grey^2: twice as much or half is nothing unusual
  for (int i = 0; i < 2; ++i) {
    std::vector<double> sigma;
    for (const Refined& r : refined) sigma.push_back(std::exp(r.fit.model.log_sigma[i]));
    const double usual = std::max(least, median(sigma));
    for (SaddlePrior& prior : priors) prior.sigma[i] = usual;
  }
  for (SaddlePrior& prior : priors) prior.log_sigma_weight = weight;
}

/// What all corners say of each: the blur, and the slope of the light, an affine field over the picture about
/// which the corners are scattered beyond their noise (shadows).
std::vector<SaddlePrior> pooled(const std::vector<Refined>& refined) {
  std::vector<SaddlePrior> priors(refined.size());
  if (refined.empty()) return priors;
  pool_blur(refined, priors);
  const double typical = typical_rms(refined);
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  for (const Refined& r : refined) centre += r.corner.pixel / static_cast<double>(refined.size());
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, 2> right = Eigen::Matrix<double, 3, 2>::Zero();
  const auto row = [&](const Refined& r) {
    const Eigen::Vector2d d = (r.corner.pixel - centre) / 100;
    return Eigen::Vector3d(1, d.x(), d.y());
  };
  const auto good = [&](const Refined& r) { return r.fit.rms < 2 * typical + 1; };
  int count = 0;
  for (const Refined& r : refined) {
    if (!good(r)) continue;
    normal += row(r) * row(r).transpose();
    right += row(r) * r.fit.model.slope.transpose();
    ++count;
  }
  if (count < 9) return priors;  // too few to know the light better than each patch does
  const Eigen::Matrix<double, 3, 2> field = normal.ldlt().solve(right);
  double scatter = 0;
  double expected = 0;
  for (const Refined& r : refined) {
    if (!good(r)) continue;
    scatter += 0.5 * (r.fit.model.slope - field.transpose() * row(r)).squaredNorm() / (count - 3);
    expected += typical * typical * r.fit.slope_variance / count;
  }
  const double variance = std::max(scatter - expected, 0.05 * expected);
  for (std::size_t i = 0; i < refined.size(); ++i) {
    priors[i].slope = field.transpose() * row(refined[i]);
    if (variance > 0) priors[i].slope_weight = typical * typical / variance;
  }
  return priors;
}

class Refiner {
 public:
  Refiner(const Board& board, const GreyView& image, std::span<const Corner> corners)
      : image_(image), points_(board.type->corners(board)), masks_(points_.size()) {
    const double pitch = corner_pitch(points_);
    for (const Corner& corner : corners) {
      const auto id = static_cast<std::size_t>(corner.id);
      masks_[id].emplace(board, points_[id], pitch);
    }
  }

  /// `corners`: none but those it was made for. `before` and `priors`: of the pass before, or empty.
  std::vector<Refined> pass(std::span<const Corner> corners, const std::vector<Refined>& before,
                            const std::vector<SaddlePrior>& priors) const {
    std::vector<Refined> refined;
    const auto lattice = neighbourhoods(points_, corners);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      if (!lattice[i]) continue;
      const auto fit = fit_corner(corners[i], *lattice[i], before.empty() ? nullptr : &before[i].fit,
                                  before.empty() ? SaddlePrior{} : priors[i]);
      if (fit) refined.push_back({{corners[i].id, fit->model.position, corners[i].covariance}, *fit});
    }
    return refined;
  }

 private:
  static bool is_sharp(const SaddleModel& model) {
    return std::exp(std::min(model.log_sigma[0], model.log_sigma[1])) < PixelEdge::sharp_sigma;
  }

  std::optional<SaddleFit> fit_corner(const Corner& corner, const Neighbourhood& lattice,
                                      const SaddleFit* before, const SaddlePrior& prior) const {
    SaddleModel start;
    if (before != nullptr) start = before->model;
    start.position = corner.pixel;
    double sigma = 0;
    const double guess = before != nullptr ? 0 : guess_sigma(image_, corner.pixel, lattice);
    for (int i = 0; i < 2; ++i) {
      if (before == nullptr) {
        start.angle[i] = std::atan2(lattice.along[i].y(), lattice.along[i].x());
        start.log_sigma[i] = std::log(guess);
      }
      start.curvature[i] = lattice.curvature[i];
      sigma = std::max(sigma, std::exp(start.log_sigma[i]));
    }
    const PrintMask& mask = *masks_[static_cast<std::size_t>(corner.id)];
    if (before != nullptr) {
      start.sharp = is_sharp(start);
      return fit_saddle(cut_patch(image_, corner.pixel, lattice, mask, sigma, 2 * most_reach), start, prior);
    }
    // The first pass finds out how sharp the picture is. The bend of the lines follows from its corners:
    // where they shift with the pixels, by 0.03 px without the pixel's square, lines seem to bend that do
    // not.
    const CornerPatch patch = cut_patch(image_, corner.pixel, lattice, mask, sigma, rough_reach);
    std::optional<SaddleFit> fit = fit_saddle(patch, start, prior, rough_tolerance);
    if (!fit || !is_sharp(fit->model)) return fit;
    start = fit->model;
    start.sharp = true;
    return fit_saddle(patch, start, prior, rough_tolerance);
  }

  const GreyView& image_;
  std::vector<Eigen::Vector2d> points_;
  std::vector<std::optional<PrintMask>> masks_;  ///< by corner id
};

}  // namespace

std::vector<Corner> refine_corners(const Board& board, const GreyView& image,
                                   std::span<const Corner> corners) {
  const Refiner refiner(board, image, corners);
  // The second pass centres the patches, and knows the lines' bend and the light from the first one's
  // corners.
  const std::vector<Refined> first = refiner.pass(corners, {}, {});
  std::vector<Corner> rough;
  for (const Refined& r : first) rough.push_back(r.corner);
  const std::vector<Refined> refined = refiner.pass(rough, first, pooled(first));
  if (refined.empty()) return {};
  const double typical = typical_rms(refined);
  std::vector<Corner> result;
  for (const Refined& r : refined) {
    // Far worse than its fellows: something lies over it. Three grey values are never held against it.
    if (r.fit.rms > 3 * typical + 3) continue;
    const double variance = std::max(quantisation, std::pow(std::max(typical, r.fit.rms), 2));
    Corner corner = r.corner;
    corner.covariance =
        variance * r.fit.information.inverse() + Eigen::Matrix2d::Identity() * model_floor * model_floor;
    if (in_picture(image, corner.pixel) && is_usable(corner.covariance)) result.push_back(corner);
  }
  return result;
}

}  // namespace ca2
