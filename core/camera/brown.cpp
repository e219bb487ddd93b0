#include "core/camera/brown.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/camera/monotone.h"

namespace ca2 {
namespace {

struct Brown {
  explicit Brown(const CameraParameters& p)
      : k1(p[4]), k2(p[5]), p1(p[6]), p2(p[7]), k3(p.size() > 8 ? p[8] : 0), rational(p.size() > 9) {
    if (!rational) return;
    k4 = p[9];
    k5 = p[10];
    k6 = p[11];
  }

  double k1, k2, p1, p2, k3;
  double k4 = 0, k5 = 0, k6 = 0;
  bool rational;

  /// Is the disc of squared radius r2 inside the domain? The radial part has the eigenvalues g' and g / r
  /// with g = r N / M (and g / r >= min g'), the decentring part has eigenvalues >= -6 |p| r: asked is
  /// g' > 6 |p| r on the whole disc.
  bool contains(double r2) const {
    const double margin = 6 * std::sqrt((p1 * p1 + p2 * p2) * r2);
    if (!rational) return positive_up_to<4>({1 - margin, 3 * k1, 5 * k2, 7 * k3}, r2);
    const std::array<double, 4> n{1, k1, k2, k3};
    const std::array<double, 4> m{1, k4, k5, k6};
    if (!positive_up_to(m, r2)) return false;
    // (g' - margin) M^2, as a polynomial in r^2.
    std::array<double, 7> c{};
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) c[i + j] += (n[i] * (1 + 2 * (i - j)) - margin * m[i]) * m[j];
    }
    return positive_up_to(c, r2);
  }

  /// The distorted point; its derivative by the undistorted one where asked for.
  Eigen::Vector2d apply(const Eigen::Vector2d& q, Eigen::Matrix2d* derivative) const {
    const double x = q.x(), y = q.y(), r2 = q.squaredNorm();
    const double n = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
    const double m = 1 + r2 * (k4 + r2 * (k5 + r2 * k6));
    const double radial = n / m;
    if (derivative) {
      const double dn = k1 + r2 * (2 * k2 + r2 * 3 * k3);
      const double dm = k4 + r2 * (2 * k5 + r2 * 3 * k6);
      const double slope = 2 * (dn - radial * dm) / m;  // d radial / d r^2, twice
      const double across = slope * x * y + 2 * (p1 * x + p2 * y);
      *derivative << radial + slope * x * x + 2 * p1 * y + 6 * p2 * x, across, across,
          radial + slope * y * y + 6 * p1 * y + 2 * p2 * x;
    }
    return {x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
            y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y};
  }

  /// Undistorted point, residual below `tolerance`. Newton from the centre: its path in the picture is the
  /// straight line to the target, and steps are halved where they leave the domain or do not help.
  std::optional<Eigen::Vector2d> invert(const Eigen::Vector2d& target, double tolerance) const {
    Eigen::Vector2d q = Eigen::Vector2d::Zero();
    Eigen::Matrix2d J;
    Eigen::Vector2d residual = apply(q, &J) - target;
    for (int iteration = 0; iteration < 100 && residual.norm() > 0.01 * tolerance; ++iteration) {
      Eigen::Vector2d step = -J.inverse() * residual;
      bool moved = false;
      for (int halving = 0; halving < 40 && !moved; ++halving, step *= 0.5) {
        const Eigen::Vector2d candidate = q + step;
        if (!contains(candidate.squaredNorm())) continue;
        Eigen::Matrix2d candidate_J;
        const Eigen::Vector2d candidate_residual = apply(candidate, &candidate_J) - target;
        if (candidate_residual.norm() >= residual.norm()) continue;
        q = candidate;
        J = candidate_J;
        residual = candidate_residual;
        moved = true;
      }
      if (!moved) break;
    }
    if (!(residual.norm() < tolerance)) return std::nullopt;
    return q;
  }
};

}  // namespace

std::optional<Eigen::Vector2d> brown_project(const CameraParameters& parameters, const Eigen::Vector3d& point,
                                             ProjectionJacobian* jacobian) {
  if (!(point.z() > 0)) return std::nullopt;
  const double inverse_z = 1 / point.z();
  const Eigen::Vector2d q = point.head<2>() * inverse_z;
  const double r2 = q.squaredNorm();
  const Brown brown(parameters);
  if (!brown.contains(r2)) return std::nullopt;
  const Eigen::Vector2d focal = parameters.head<2>();
  Eigen::Matrix2d J;
  const Eigen::Vector2d distorted = brown.apply(q, jacobian ? &J : nullptr);
  if (jacobian) {
    Eigen::Matrix<double, 2, 3> by_point;
    by_point << inverse_z, 0, -q.x() * inverse_z, 0, inverse_z, -q.y() * inverse_z;
    jacobian->point = focal.asDiagonal() * J * by_point;

    const double x = q.x(), y = q.y();
    const double n = 1 + r2 * (brown.k1 + r2 * (brown.k2 + r2 * brown.k3));
    const double inverse_m = 1 / (1 + r2 * (brown.k4 + r2 * (brown.k5 + r2 * brown.k6)));
    auto& by_parameters = jacobian->parameters;
    by_parameters.setZero(2, parameters.size());
    by_parameters(0, 0) = distorted.x();
    by_parameters(1, 1) = distorted.y();
    by_parameters(0, 2) = 1;
    by_parameters(1, 3) = 1;
    const Eigen::Vector2d radial = focal.cwiseProduct(q) * inverse_m;
    by_parameters.col(4) = radial * r2;
    by_parameters.col(5) = radial * (r2 * r2);
    by_parameters.col(6) = focal.cwiseProduct(Eigen::Vector2d(2 * x * y, r2 + 2 * y * y));
    by_parameters.col(7) = focal.cwiseProduct(Eigen::Vector2d(r2 + 2 * x * x, 2 * x * y));
    if (parameters.size() > 8) by_parameters.col(8) = radial * (r2 * r2 * r2);
    if (brown.rational) {
      for (int i = 0; i < 3; ++i) by_parameters.col(9 + i) = -radial * (n * inverse_m * std::pow(r2, i + 1));
    }
  }
  return Eigen::Vector2d(focal.cwiseProduct(distorted) + parameters.segment<2>(2));
}

std::optional<Eigen::Vector3d> brown_unproject(const CameraParameters& parameters,
                                               const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d target =
      (pixel - parameters.segment<2>(2)).cwiseQuotient(Eigen::Vector2d(parameters.head<2>()));
  const double tolerance = 1e-9 / std::max(parameters[0], parameters[1]);
  const std::optional<Eigen::Vector2d> q = Brown(parameters).invert(target, tolerance);
  if (!q) return std::nullopt;
  return Eigen::Vector3d(q->x(), q->y(), 1).normalized();
}

}  // namespace ca2
