/// @file What a saddle model shows at a pixel, with its derivatives: the inner loop of the fit.
#pragma once

#include <cmath>

#include "core/board/refine/edge_profile.h"
#include "core/board/refine/saddle_fit.h"

namespace ca2 {

namespace saddle_parameters {
// Order of the fitted parameters: what every pixel sees, then what belongs to one edge, by edge.
enum { x_, y_, offset_, gain_, slope_, common = slope_ + 2, angle_ = common, log_sigma_, per_edge = 2 };
constexpr int size = common + 2 * per_edge;
}  // namespace saddle_parameters

/// What the model shows at a pixel.
struct SeenSaddle {
  double product = 0;  ///< M
  double by_c[2];      ///< 1/px
  double by_sigma[2];  ///< by log sigma
  double by_rho = 0;
  double along[2];   ///< px
  double across[2];  ///< px
  bool edge[2];      ///< is the pixel within the blur of this edge?
};

/// The model with what does not change from pixel to pixel worked out.
class SaddleEvaluator {
 public:
  explicit SaddleEvaluator(const SaddleModel& model) : m_(model) {
    for (int i = 0; i < 2; ++i) {
      t_[i] = {std::cos(m_.angle[i]), std::sin(m_.angle[i])};
      n_[i] = {-t_[i].y(), t_[i].x()};
      const double sigma = std::exp(m_.log_sigma[i]);
      edge_[i] = PixelEdge(m_.angle[i], sigma, m_.sharp);
      variance_[i] = sigma * sigma;
    }
    rho_ = n_[0].dot(n_[1]);
    rho_slope_ = std::sin(m_.angle[1] - m_.angle[0]);
  }

  SeenSaddle see(double x, double y) const {
    SeenSaddle s;
    const double dx = x - m_.position.x();
    const double dy = y - m_.position.y();
    double c[2];
    for (int i = 0; i < 2; ++i) {
      s.along[i] = t_[i].x() * dx + t_[i].y() * dy;
      s.across[i] = n_[i].x() * dx + n_[i].y() * dy;
      c[i] = s.across[i] + m_.curvature[i] * s.along[i] * s.along[i];
      s.edge[i] = std::abs(c[i]) < edge_[i].support();
    }
    PixelEdge::Value p[2];
    for (int i = 0; i < 2; ++i) {
      p[i] = s.edge[i] ? edge_[i].at(c[i]) : PixelEdge::Value{c[i] > 0 ? 1.0 : -1.0, 0, 0};
    }
    s.product = p[0].value * p[1].value;
    for (int i = 0; i < 2; ++i) {
      s.by_c[i] = p[i].slope * p[1 - i].value;
      s.by_sigma[i] = variance_[i] * p[i].bend * p[1 - i].value;
    }
    if (s.edge[0] && s.edge[1]) add_correlation(c, s);
    return s;
  }

  double grey(const SeenSaddle& s, double x, double y) const {
    return m_.offset + m_.slope.x() * (x - m_.light_origin.x()) + m_.slope.y() * (y - m_.light_origin.y()) +
           m_.gain * s.product;
  }

  /// The derivatives of the grey value that every pixel on an edge has.
  template <class Row>
  void common_row(const SeenSaddle& s, double x, double y, Row& row) const {
    double by[2] = {0, 0};
    for (int i = 0; i < 2; ++i) {
      const double bend = 2 * m_.curvature[i] * s.along[i];
      by[0] -= s.by_c[i] * (n_[i].x() + bend * t_[i].x());
      by[1] -= s.by_c[i] * (n_[i].y() + bend * t_[i].y());
    }
    using namespace saddle_parameters;
    row[x_] = static_cast<float>(m_.gain * by[0]);
    row[y_] = static_cast<float>(m_.gain * by[1]);
    row[offset_] = 1;
    row[gain_] = static_cast<float>(s.product);
    row[slope_] = static_cast<float>(x - m_.light_origin.x());
    row[slope_ + 1] = static_cast<float>(y - m_.light_origin.y());
  }

  /// Those by the angle and log sigma of one edge.
  template <class Row>
  void edge_row(const SeenSaddle& s, int i, int at, Row& row) const {
    const double bend = 2 * m_.curvature[i] * s.along[i];
    row[at] = static_cast<float>(m_.gain * (s.by_c[i] * (bend * s.across[i] - s.along[i]) +
                                            (i == 0 ? rho_slope_ : -rho_slope_) * s.by_rho));
    row[at + 1] = static_cast<float>(m_.gain * s.by_sigma[i]);
  }

 private:
  /// Where both edges are near and not square to each other.
  void add_correlation(const double (&c)[2], SeenSaddle& s) const {
    const double z[2] = {c[0] * edge_[0].per_wide(), c[1] * edge_[1].per_wide()};
    const double both = EdgeProfile::at(z[0]).slope * EdgeProfile::at(z[1]).slope;
    const double q0 = z[0] * z[0] - 1;
    const double q1 = z[1] * z[1] - 1;
    const double r2 = rho_ * rho_;
    const double terms = rho_ + r2 * (0.5 * z[0] * z[1] + rho_ / 6 * q0 * q1);
    s.product += both * terms;
    s.by_rho = both * (1 + rho_ * z[0] * z[1] + r2 * q0 * q1 / 2);
    const double by_z[2] = {both * (r2 * (0.5 * z[1] + rho_ / 3 * z[0] * q1) - z[0] * terms),
                            both * (r2 * (0.5 * z[0] + rho_ / 3 * z[1] * q0) - z[1] * terms)};
    for (int i = 0; i < 2; ++i) {
      s.by_c[i] += by_z[i] * edge_[i].per_wide();
      s.by_sigma[i] -= by_z[i] * z[i] * variance_[i] * edge_[i].per_wide() * edge_[i].per_wide();
    }
  }

  const SaddleModel& m_;
  Eigen::Vector2d t_[2];
  Eigen::Vector2d n_[2];
  PixelEdge edge_[2];
  double variance_[2];
  double rho_;
  double rho_slope_;  ///< by the first angle; by the second its negative
};

}  // namespace ca2
