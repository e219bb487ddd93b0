// Pinhole with rational radial and decentring distortion: ROS rational_polynomial, OpenCV's 8 coefficients.
#include <array>

#include "core/camera/brown.h"
#include "core/camera/check_parameters.h"

namespace ca2 {
namespace {

class PinholeRational final : public CameraModel {
 public:
  std::string_view name() const override { return "pinhole_rational"; }
  std::span<const std::string_view> parameter_names() const override {
    static constexpr std::array<std::string_view, 12> names{"fx", "fy", "cx", "cy", "k1", "k2",
                                                            "p1", "p2", "k3", "k4", "k5", "k6"};
    return names;
  }
  /// A wide lens is not reached from zeros: on the way the denominator gets a root inside the picture. So
  /// also the Pade approximation of atan(r) / r, the equidistant fisheye, which has none anywhere.
  std::vector<CameraParameters> initial_shapes() const override {
    CameraParameters fisheye = CameraParameters::Zero(8);
    fisheye << 735.0 / 945, 64.0 / 945, 0, 0, 0, 1050.0 / 945, 225.0 / 945, 0;
    return {CameraParameters::Zero(8), fisheye};
  }

  std::optional<Eigen::Vector2d> project(const CameraParameters& parameters, const Eigen::Vector3d& point,
                                         ProjectionJacobian* jacobian) const override {
    return brown_project(parameters, point, jacobian);
  }
  std::optional<Eigen::Vector3d> unproject(const CameraParameters& parameters,
                                           const Eigen::Vector2d& pixel) const override {
    return brown_unproject(parameters, pixel);
  }
  std::optional<std::string> invalid(const CameraParameters& parameters) const override {
    return common_invalid(*this, parameters);
  }
};

}  // namespace

const CameraModel& pinhole_rational_model();
const CameraModel& pinhole_rational_model() {
  static const PinholeRational model;
  return model;
}

}  // namespace ca2
