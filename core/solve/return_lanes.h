/// @file The loops over all returns of a board, four at a time.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/geometry/pose.h"
#include "core/solve/range_correction.h"

namespace ca2 {

/// Returns in arrays of whole lanes: what fills the last one has the range 0.
struct ReturnArrays {
  static constexpr Eigen::Index lanes = 4;

  /// For so many returns.
  explicit ReturnArrays(std::size_t size);

  /// `r` [m] along the unit ray `u`, which begins at `height` [m] on the z axis.
  void set(std::size_t i, const Eigen::Vector3d& u, double height, double r);
  Eigen::Vector3d ray(std::size_t i) const {
    return rays.row(static_cast<Eigen::Index>(i)).head<3>().cast<double>();
  }
  double height(std::size_t i) const { return rays(static_cast<Eigen::Index>(i), 3); }

  Eigen::Matrix<float, Eigen::Dynamic, 4>
      rays;               ///< x, y, z of the unit ray, and where on the z axis it begins, m
  Eigen::VectorXd range;  ///< m, along the ray
};

/// Where the rays meet a plate.
struct Meetings {
  Eigen::VectorXd along;  ///< m, along the ray; not positive or NaN: it does not meet it
  Eigen::VectorXd x, y;   ///< m, by the board's axes
};
void meet_plate(const ReturnArrays& returns, const Pose& T_lidar_board, Meetings& meetings);
/// The same, but for the plane q only, see `inverse_plane`: `along`.
void meet_plane(const ReturnArrays& returns, const Eigen::Vector3d& q, Eigen::VectorXd& along);

/// The sums of the returns whose `taken` is 1 (the others' is 0), about the plane q, which their rays meet at
/// `along`. `of_class`: the class of each return, as an index into sums.classes. The sums are begun anew but
/// for these classes' names.
void sum_returns(const ReturnArrays& returns, const Eigen::Vector3d& q, const Eigen::VectorXd& along,
                 const Eigen::VectorXd& taken, std::span<const std::uint16_t> of_class,
                 CorrectionEvidence& sums);

}  // namespace ca2
