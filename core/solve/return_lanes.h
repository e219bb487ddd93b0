/// @file The loops over all returns of a board, four at a time.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/geometry/pose.h"
#include "core/solve/range_correction.h"

namespace ca2 {

/// Returns in arrays of whole lanes: what fills the last one has the range 0. In single precision, as points
/// are: 0.2 um at 3 m, and of a thousand views what memory has to bring again and again.
struct ReturnArrays {
  static constexpr Eigen::Index lanes = 4;

  /// For so many returns, each of which is to be set, or left out at the end.
  explicit ReturnArrays(std::size_t size);

  /// `r` [m] along the unit ray `u`, which begins at `height` [m] on the z axis.
  void set(std::size_t i, const Eigen::Vector3d& u, float height, double r) {
    const auto row = static_cast<Eigen::Index>(i);
    rays(row, 0) = static_cast<float>(u.x());
    rays(row, 1) = static_cast<float>(u.y());
    rays(row, 2) = static_cast<float>(u.z());
    rays(row, 3) = height;
    range(row) = static_cast<float>(r);
  }
  /// There are no more than `size`.
  void leave_out_from(std::size_t size);
  Eigen::Vector3d ray(std::size_t i) const {
    return rays.row(static_cast<Eigen::Index>(i)).head<3>().cast<double>();
  }
  double height(std::size_t i) const { return rays(static_cast<Eigen::Index>(i), 3); }

  Eigen::Matrix<float, Eigen::Dynamic, 4>
      rays;               ///< x, y, z of the unit ray, and where on the z axis it begins, m
  Eigen::VectorXf range;  ///< m, along the ray
};

/// Where the rays meet a plate: `along` them, m (not positive or NaN: they do not), and `x`, `y` by the
/// board's axes, m.
void meet_plate(const ReturnArrays& returns, const Pose& T_lidar_board, Eigen::VectorXf& along,
                Eigen::VectorXd& x, Eigen::VectorXd& y);
/// The same, but for the plane q only, see `inverse_plane`: `along`.
void meet_plane(const ReturnArrays& returns, const Eigen::Vector3d& q, Eigen::VectorXf& along);

/// The part of a plate whose returns take part, with its middle at (x, y) of the board's axes, m.
struct PlatePart {
  double x, y, half_width, half_height;
  double rim;          ///< within this of its rim it is not certain whether a return takes part
  double bias, limit;  ///< nor is it further than `limit` from the ranges the plate would give, off by `bias`
};
/// Of the returns that meet the plate's plane `along` their rays at `x`, `y` (m): 1 in `certain` where they
/// take part for certain, 1 in `open` where they may, 0 elsewhere. Gives how far off the certain ones' ranges
/// are at most, m.
double find_on_plate(const ReturnArrays& returns, const Eigen::VectorXf& along, const Eigen::VectorXd& x,
                     const Eigen::VectorXd& y, const PlatePart& part, Eigen::VectorXf& certain,
                     Eigen::VectorXf& open);

/// Which of the first `count` returns end within `limit` [m] of `along`: 1 in `taken`, 0 the others.
struct Near {
  std::size_t count = 0;
  double spread = 0;          ///< m, the furthest of them
  Eigen::Vector3d low, high;  ///< m: a box about them, their rays as if they all began in the origin
};
Near find_near(const ReturnArrays& returns, std::size_t count, const Eigen::VectorXf& along, double limit,
               Eigen::VectorXf& taken);

/// The sums of the returns whose `taken` is 1 (the others' is 0), about the plane q, which their rays meet at
/// `along`. `of_class`: the class of each return, as an index into sums.classes. The sums are begun anew but
/// for these classes' names.
void sum_returns(const ReturnArrays& returns, const Eigen::Vector3d& q, const Eigen::VectorXf& along,
                 const Eigen::VectorXf& taken, std::span<const std::uint16_t> of_class,
                 CorrectionEvidence& sums);

}  // namespace ca2
