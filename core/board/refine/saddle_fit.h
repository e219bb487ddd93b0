/// @file A photometric model of one chessboard corner, fitted to the pixels round it.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace ca2 {

/// A pixel that takes part in the fit.
struct PatchPixel {
  double x;     ///< px
  double y;     ///< px
  double grey;  ///< 0..255
};

/// The pixels far from both edges, which are either the one grey or the other: all that a fit needs of them
/// are sums over rows (1, side, x, y), x and y from an origin. Their side is the sign of M.
struct FlatPixels {
  Eigen::Matrix4d squares = Eigen::Matrix4d::Zero();  ///< of the rows
  Eigen::Vector4d greys = Eigen::Vector4d::Zero();    ///< of the rows times the grey
  double grey_squares = 0;
  int count = 0;

  void add(double side, double x, double y, double grey) {
    const Eigen::Vector4d row(1, side, x, y);
    squares += row * row.transpose();
    greys += grey * row;
    grey_squares += grey * grey;
    ++count;
  }
};

/// What is fitted.
struct CornerPatch {
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();  ///< px, of the flat pixels and of the light's slope
  std::vector<PatchPixel> edge;
  FlatPixels flat;
};

/// Two crossing edges under a Gaussian blur, as pixels see them:
///   grey(x) = offset + slope . (x - light_origin) + gain M(c0, c1),  d = x - position,
///   c_i = n_i . d + curvature_i (t_i . d)^2,  t_i = (cos angle_i, sin angle_i),  n_i = its left.
/// M is P(c0) P(c1) with P the profile of an edge averaged over the pixel's square (PixelEdge) when the edges
/// are square to each other; otherwise the blur across the one is correlated with that across the other by
/// rho = n_0 . n_1, and Mehler's expansion of the bivariate normal adds, with z_i = c_i / (sigma of blur and
/// pixel) and E(z) = erf(z / sqrt 2),
///   E'(z0) E'(z1) (rho + rho^2 z0 z1 / 2 + rho^3 (z0^2 - 1)(z1^2 - 1) / 6).
/// The lines of a chessboard stay lines under perspective, so that no homography is needed; a lens bends
/// them, and how much is known better from the neighbouring corners than from the patch (where it would cost
/// half of the accuracy): curvature is given, not fitted. Uneven light is a slope of the whole; a slope of
/// the gain would move the corner by 0.001 px at most, and fitting it costs a quarter of the accuracy.
struct SaddleModel {
  Eigen::Vector2d position;                         ///< px
  double angle[2] = {0, 0};                         ///< rad
  double log_sigma[2] = {0, 0};                     ///< of px; two, since motion and astigmatism blur one way
  double offset = 0;                                ///< grey
  double gain = 0;                                  ///< grey
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();  ///< grey/px
  double curvature[2] = {0, 0};                     ///< 1/px
  Eigen::Vector2d light_origin = Eigen::Vector2d::Zero();  ///< px, where the slope is nought
  bool sharp = false;  ///< the pixel's square exactly (PixelEdge): needed below PixelEdge::sharp_sigma

  bool operator==(const SaddleModel&) const = default;
};

/// What is known of a patch beforehand, from the other corners. A slope of the light along an edge looks like
/// a shift across it, and costs a quarter of the accuracy when nothing is known of it. Without any blur an
/// edge along the pixels does not say how much there is, and where it lies depends on that.
struct SaddlePrior {
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();  ///< grey/px
  double slope_weight = 0;       ///< px^2: variance of the grey values over that of the slope
  double sigma[2] = {0.3, 0.3};  ///< px, blur of the edges: a guess
  double log_sigma_weight = 4;   ///< grey^2: the same for its logarithm
};

struct SaddleFit {
  SaddleModel model;
  double slope_variance = 0;    ///< (grey/px)^2 for unit noise, mean of both directions
  Eigen::Matrix2d information;  ///< of the position with everything else free, for unit noise, 1/px^2
  double rms = 0;               ///< grey, of the residuals per degree of freedom
};

/// Least squares from a start within about half a pixel (its light need not be set); nothing when
/// it runs away or there are too few pixels. A step of less than `tolerance` [px] is the last.
std::optional<SaddleFit> fit_saddle(const CornerPatch& patch, const SaddleModel& start,
                                    const SaddlePrior& prior = {}, double tolerance = 1e-4);

/// Grey value of the model averaged over the pixel at (x, y).
double model_grey(const SaddleModel& model, double x, double y);

}  // namespace ca2
