// Kannala and Brandt 2006 in OpenCV's form: the radius in the picture is an odd polynomial of the angle off
// the axis, theta_d = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8). Points beside and behind
// the camera project too, as far as theta_d rises.
#include <algorithm>
#include <array>
#include <cmath>

#include "core/camera/check_parameters.h"
#include "core/camera/monotone.h"

namespace ca2 {
namespace {

struct Polynomial {
  explicit Polynomial(const CameraParameters& p) : k{p[4], p[5], p[6], p[7]} {}

  std::array<double, 4> k;

  double value(double theta) const {
    const double t2 = theta * theta;
    return theta * (1 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))));
  }
  double derivative(double theta) const {
    const double t2 = theta * theta;
    return 1 + t2 * (3 * k[0] + t2 * (5 * k[1] + t2 * (7 * k[2] + t2 * 9 * k[3])));
  }
  /// Does theta_d rise all the way to theta? At pi the direction would be ambiguous.
  bool contains(double theta) const {
    return theta < M_PI && positive_up_to<5>({1, 3 * k[0], 5 * k[1], 7 * k[2], 9 * k[3]}, theta * theta);
  }

  /// The angle whose theta_d is `target`: Newton kept inside a bracket. "In the domain, and not beyond the
  /// target" holds below the answer and fails above it, also where the domain ends, so that bisection on it
  /// is always there to fall back on.
  std::optional<double> invert(double target, double tolerance) const {
    double low = 0, high = M_PI;
    double theta = std::min(target, 0.5 * M_PI);
    for (int iteration = 0; iteration < 100; ++iteration) {
      const bool inside = contains(theta);
      const double residual = value(theta) - target;
      if (inside && std::abs(residual) <= 0.01 * tolerance) return theta;
      (inside && residual < 0 ? low : high) = theta;
      const double newton = theta - residual / derivative(theta);
      theta = inside && newton > low && newton < high ? newton : 0.5 * (low + high);
    }
    if (contains(low) && std::abs(value(low) - target) < tolerance) return low;
    return std::nullopt;
  }
};

class KannalaBrandt final : public CameraModel {
 public:
  std::string_view name() const override { return "kannala_brandt"; }
  std::span<const std::string_view> parameter_names() const override {
    static constexpr std::array<std::string_view, 8> names{"fx", "fy", "cx", "cy", "k1", "k2", "k3", "k4"};
    return names;
  }

  std::optional<Eigen::Vector2d> project(const CameraParameters& parameters, const Eigen::Vector3d& point,
                                         ProjectionJacobian* jacobian) const override {
    const double z = point.z();
    const double rho = std::sqrt(point.x() * point.x() + point.y() * point.y());
    if (!std::isfinite(rho) || !std::isfinite(z) || (rho == 0 && z <= 0)) return std::nullopt;
    const double theta = std::atan2(rho, z);
    const Polynomial polynomial(parameters);
    if (!polynomial.contains(theta)) return std::nullopt;
    const double theta_d = polynomial.value(theta);
    const double scale = rho > 0 ? theta_d / rho : 1 / z;  // the limit on the axis
    const Eigen::Vector2d distorted = scale * point.head<2>();
    const Eigen::Vector2d focal = parameters.head<2>();
    if (jacobian) {
      const Eigen::Vector2d n =
          rho > 0 ? Eigen::Vector2d(point.head<2>() / rho) : Eigen::Vector2d::UnitX();  // away from the axis
      const double slope = polynomial.derivative(theta) / (rho * rho + z * z);
      // Along n the radius follows theta (d theta / d rho = z / |p|^2), across it turns with the point.
      const double along = slope * z - scale, mixed = along * n.x() * n.y();
      jacobian->point << focal.x() * (scale + along * n.x() * n.x()), focal.x() * mixed,
          -slope * focal.x() * point.x(), focal.y() * mixed, focal.y() * (scale + along * n.y() * n.y()),
          -slope * focal.y() * point.y();
      auto& by_parameters = jacobian->parameters;
      by_parameters.resize(2, 8);
      by_parameters.leftCols<4>() << distorted.x(), 0, 1, 0, 0, distorted.y(), 0, 1;
      const Eigen::Vector2d outwards = focal.cwiseProduct(n);
      double power = theta;
      for (int i = 0; i < 4; ++i) {
        power *= theta * theta;
        by_parameters(0, 4 + i) = power * outwards.x();
        by_parameters(1, 4 + i) = power * outwards.y();
      }
    }
    return Eigen::Vector2d(focal.cwiseProduct(distorted) + parameters.segment<2>(2));
  }

  std::optional<Eigen::Vector3d> unproject(const CameraParameters& parameters,
                                           const Eigen::Vector2d& pixel) const override {
    const Eigen::Vector2d distorted =
        (pixel - parameters.segment<2>(2)).cwiseQuotient(Eigen::Vector2d(parameters.head<2>()));
    const double radius = distorted.norm();
    if (!std::isfinite(radius)) return std::nullopt;
    const double tolerance = 1e-9 / std::max(parameters[0], parameters[1]);
    const std::optional<double> theta = Polynomial(parameters).invert(radius, tolerance);
    if (!theta) return std::nullopt;
    // On the axis (radius 0) the direction is z whatever the quotient.
    const Eigen::Vector2d n = distorted / std::max(radius, 1e-300);
    const double sine = std::sin(*theta);
    return Eigen::Vector3d(sine * n.x(), sine * n.y(), std::cos(*theta));
  }

  std::optional<std::string> invalid(const CameraParameters& parameters) const override {
    return common_invalid(*this, parameters);
  }
};

}  // namespace

const CameraModel& kannala_brandt_model();
const CameraModel& kannala_brandt_model() {
  static const KannalaBrandt model;
  return model;
}

}  // namespace ca2
