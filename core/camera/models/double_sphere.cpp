// The double sphere model of Usenko, Demmel and Cremers, 3DV 2018: the point is projected onto a unit sphere,
// then onto a second one shifted by xi, then through a pinhole shifted by alpha / (1 - alpha). Closed form in
// both directions.
#include <array>
#include <cmath>

#include "core/camera/check_parameters.h"

namespace ca2 {
namespace {

class DoubleSphere final : public CameraModel {
 public:
  std::string_view name() const override { return "double_sphere"; }
  std::span<const std::string_view> parameter_names() const override {
    static constexpr std::array<std::string_view, 6> names{"fx", "fy", "cx", "cy", "xi", "alpha"};
    return names;
  }
  /// Zeros would be a pinhole, which cannot see the rim of a fisheye. A lens usually has a second fit with xi
  /// of the other sign, a few hundredths of a pixel worse.
  std::vector<CameraParameters> initial_shapes() const override {
    return {Eigen::Vector2d(-0.2, 0.58), Eigen::Vector2d(0.25, 0.65)};
  }

  std::optional<Eigen::Vector2d> project(const CameraParameters& parameters, const Eigen::Vector3d& point,
                                         ProjectionJacobian* jacobian) const override {
    const double xi = parameters[4], alpha = parameters[5];
    const double rho2 = point.head<2>().squaredNorm();
    const double d1 = std::sqrt(rho2 + point.z() * point.z());
    const double zeta = xi * d1 + point.z();
    const double d2 = std::sqrt(rho2 + zeta * zeta);
    // Up to here the radius rises with the angle and the denominator is positive. It is the paper's condition
    // before it is written with w2: that form moves the rim by a few tenths of a degree where xi is not 0,
    // and then disagrees with the pixels of the paper's own inverse, r^2 <= 1 / (2 alpha - 1).
    const double w1 = alpha > 0.5 ? (1 - alpha) / alpha : alpha / (1 - alpha);
    if (!(zeta > -w1 * d2) || !std::isfinite(d2)) return std::nullopt;
    const double inverse = 1 / (alpha * d2 + (1 - alpha) * zeta);
    const Eigen::Vector2d m = point.head<2>() * inverse;
    const Eigen::Vector2d focal = parameters.head<2>();
    if (jacobian) {
      const Eigen::RowVector3d by_d1 = point.transpose() / d1;
      const Eigen::RowVector3d by_zeta = xi * by_d1 + Eigen::RowVector3d::UnitZ();
      Eigen::RowVector3d by_d2 = zeta * by_zeta;
      by_d2.head<2>() += point.head<2>().transpose();
      by_d2 /= d2;
      const Eigen::RowVector3d denominator = alpha * by_d2 + (1 - alpha) * by_zeta;
      const Eigen::Vector2d fm = focal.cwiseProduct(m) * inverse;
      jacobian->point = -fm * denominator;
      jacobian->point(0, 0) += focal.x() * inverse;
      jacobian->point(1, 1) += focal.y() * inverse;
      auto& by_parameters = jacobian->parameters;
      by_parameters.setZero(2, 6);
      by_parameters(0, 0) = m.x();
      by_parameters(1, 1) = m.y();
      by_parameters(0, 2) = 1;
      by_parameters(1, 3) = 1;
      by_parameters.col(4) = -fm * (d1 * (alpha * zeta / d2 + 1 - alpha));
      by_parameters.col(5) = -fm * (d2 - zeta);
    }
    return Eigen::Vector2d(focal.cwiseProduct(m) + parameters.segment<2>(2));
  }

  std::optional<Eigen::Vector3d> unproject(const CameraParameters& parameters,
                                           const Eigen::Vector2d& pixel) const override {
    const double xi = parameters[4], alpha = parameters[5];
    const Eigen::Vector2d m =
        (pixel - parameters.segment<2>(2)).cwiseQuotient(Eigen::Vector2d(parameters.head<2>()));
    const double r2 = m.squaredNorm();
    const double radicand = 1 - (2 * alpha - 1) * r2;
    if (!(radicand > 0)) return std::nullopt;
    const double mz = (1 - alpha * alpha * r2) / (alpha * std::sqrt(radicand) + 1 - alpha);
    const double scale = (mz * xi + std::sqrt(mz * mz + (1 - xi * xi) * r2)) / (mz * mz + r2);
    const Eigen::Vector3d direction(scale * m.x(), scale * m.y(), scale * mz - xi);
    if (!direction.allFinite()) return std::nullopt;
    return direction.normalized();
  }

  std::optional<std::string> invalid(const CameraParameters& parameters) const override {
    if (const auto reason = common_invalid(*this, parameters)) return reason;
    if (!(std::abs(parameters[4]) < 1)) return "xi is not between -1 and 1";
    if (!(parameters[5] >= 0 && parameters[5] <= 1)) return "alpha is not between 0 and 1";
    return std::nullopt;
  }
};

}  // namespace

const CameraModel& double_sphere_model();
const CameraModel& double_sphere_model() {
  static const DoubleSphere model;
  return model;
}

}  // namespace ca2
