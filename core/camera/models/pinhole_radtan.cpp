// Pinhole with polynomial radial and decentring distortion: ROS plumb_bob, Kalibr pinhole-radtan, OpenCV's 4
// or 5 coefficients.
#include <array>

#include "core/camera/brown.h"
#include "core/camera/check_parameters.h"

namespace ca2 {
namespace {

class PinholeRadtan final : public CameraModel {
 public:
  std::string_view name() const override { return "pinhole_radtan"; }
  std::span<const std::string_view> parameter_names() const override {
    static constexpr std::array<std::string_view, 9> names{"fx", "fy", "cx", "cy", "k1",
                                                           "k2", "p1", "p2", "k3"};
    return names;
  }
  int optional_parameters() const override { return 1; }
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

const CameraModel& pinhole_radtan_model();
const CameraModel& pinhole_radtan_model() {
  static const PinholeRadtan model;
  return model;
}

}  // namespace ca2
