/// @file The projection models of cameras behind one interface, and a camera as a value.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/types/result.h"

namespace ca2 {

/// No model has more parameters than this: Jacobians then never allocate.
inline constexpr int max_camera_parameters = 12;
using CameraParameters = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, max_camera_parameters, 1>;

/// Derivatives of a pixel, where the projection exists.
struct ProjectionJacobian {
  Eigen::Matrix<double, 2, 3> point;                                                 ///< by the point, px/m
  Eigen::Matrix<double, 2, Eigen::Dynamic, 0, 2, max_camera_parameters> parameters;  ///< by the parameters
};

/// A projection model without state: the parameters are passed in, so that an optimiser can vary them.
/// Camera frame: x right, y down, z forward. Parameters always begin fx, fy, cx, cy [px].
class CameraModel {
 public:
  virtual ~CameraModel() = default;
  virtual std::string_view name() const = 0;
  /// Names in order; optional trailing ones are listed too ("k3" of pinhole_radtan).
  virtual std::span<const std::string_view> parameter_names() const = 0;
  /// How many of them may be left out at the end (0 or 1; a missing one counts as 0).
  virtual int optional_parameters() const { return 0; }
  /// What may follow fx fy cx cy where an estimation starts from nothing, each tried to the end: no
  /// distortion, unless the model has better places to start from or several minima; the likeliest first.
  virtual std::vector<CameraParameters> initial_shapes() const {
    return {CameraParameters::Zero(static_cast<Eigen::Index>(parameter_names().size()) - 4)};
  }

  /// Pixel of a point [m]; nothing where the model does not project it (behind, outside its valid domain:
  /// also where a distortion polynomial has folded back, so that a pixel has one point's direction only).
  virtual std::optional<Eigen::Vector2d> project(const CameraParameters& parameters,
                                                 const Eigen::Vector3d& point,
                                                 ProjectionJacobian* jacobian = nullptr) const = 0;
  /// Unit direction whose projection is `pixel`, to 1e-9 px; nothing where there is none.
  virtual std::optional<Eigen::Vector3d> unproject(const CameraParameters& parameters,
                                                   const Eigen::Vector2d& pixel) const = 0;
  /// Are these numbers a camera (count, finite, focal lengths positive, parameters in the model's domain)?
  /// The reason when not.
  virtual std::optional<std::string> invalid(const CameraParameters& parameters) const = 0;
};

/// The models of models.def, in its order.
std::span<const CameraModel* const> camera_models();
/// nullptr when there is none of that name.
const CameraModel* find_camera_model(std::string_view name);

/// A calibrated camera: a model, its parameters and the size of its pictures.
struct Camera {
  const CameraModel* model = nullptr;
  CameraParameters parameters;
  int width = 0;   ///< px
  int height = 0;  ///< px

  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& p,
                                         ProjectionJacobian* jacobian = nullptr) const {
    return model->project(parameters, p, jacobian);
  }
  std::optional<Eigen::Vector3d> unproject(const Eigen::Vector2d& pixel) const {
    return model->unproject(parameters, pixel);
  }
  /// Is the pixel inside the picture, `margin` px away from its rim?
  bool contains(const Eigen::Vector2d& pixel, double margin = 0) const {
    return pixel.x() >= margin && pixel.y() >= margin && pixel.x() <= width - 1 - margin &&
           pixel.y() <= height - 1 - margin;
  }
};

}  // namespace ca2
