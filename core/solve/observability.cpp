#include "core/solve/observability.h"

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>

#include "core/types/text.h"

namespace ca2 {
namespace {

constexpr double degrees = 180 / M_PI;
/// Tilts that vary less than this (rms, in the direction in which they vary least) are refused whatever the
/// noise: 1 degree. Two holds of a person differ by more by chance.
constexpr double min_tilt = 0.0175;
/// An answer less certain than this is none.
constexpr double max_sigma_translation = 0.05;  // m
constexpr double max_sigma_rotation = 0.05;     // rad
/// Within this, and cross-checked by a fourth view, it is good.
constexpr double good_sigma_translation = 0.005;  // m
constexpr double good_sigma_rotation = 0.005;     // rad

int largest_axis(const Eigen::Vector3d& v) {
  int axis = 0;
  v.cwiseAbs().maxCoeff(&axis);
  return axis;
}

/// What turning of the board makes its normal vary along this axis of the camera frame.
const char* cure(int axis) {
  switch (axis) {
    case 0:
      return "turn the board more to the left and to the right (about its vertical), by 20 to 40 deg";
    case 1:
      return "tip the board's top more towards and away from the camera, by 20 to 40 deg";
    default:
      return "show the board at the sides of the camera's picture too, facing away from its axis";
  }
}

const char* direction(bool rotation, int axis) {
  static constexpr std::array<std::array<const char*, 3>, 2> words{{
      {"position along the camera's x (left-right)", "position along the camera's y (up-down)",
       "position along the camera's z (depth)"},
      {"rotation about the camera's x (pitch)", "rotation about the camera's y (yaw)",
       "rotation about the camera's z (roll)"},
  }};
  return words[rotation ? 1 : 0][static_cast<std::size_t>(axis)];
}

/// Does the direction in which the boards' normals vary least leave the answer open? Fewer than three views
/// are refused where no rims make up for it, and two that are alike in any case: they check nothing.
Result<void> judge_tilts(const std::string& pair, const PairEvidence& evidence, int& flat_axis) {
  const auto count = static_cast<int>(evidence.normals.size());
  if (count < 3 && (count == 0 || !evidence.rims)) {
    return fail(ErrorCode::refused, pair,
                formatted("only %d view%s could be used, and three are the least that determine the answer",
                          count, count == 1 ? "" : "s"),
                "show the board in more places, each at another tilt");
  }
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& n : evidence.normals) scatter += n * n.transpose() / count;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> spread(scatter);
  // The noise of the normals looks like tilt: it does not count.
  const double noise = std::pow(evidence.normal_sigma, 2);
  flat_axis = largest_axis(spread.eigenvectors().col(0));
  if (count == 1) return {};
  if (count == 2) {
    const double apart =
        std::sqrt(std::max(0.0, (evidence.normals[0] - evidence.normals[1]).squaredNorm() - 2 * noise));
    if (apart >= min_tilt) return {};
    return fail(
        ErrorCode::refused, pair,
        formatted("the two boards are nearly parallel (%.1f deg apart): neither says anything that the "
                  "other could check",
                  apart * degrees),
        cure(flat_axis));
  }
  const double tilt = std::sqrt(std::max(0.0, spread.eigenvalues()(0) - noise));
  if (tilt >= min_tilt) return {};
  const double second = std::sqrt(std::max(0.0, spread.eigenvalues()(1)));
  return fail(
      ErrorCode::refused, pair,
      formatted(second < 2 * min_tilt ? "the boards are nearly parallel (tilt varies by %.1f deg): "
                                        "where the LiDAR sits beside them, and "
                                        "how it is turned about their normal, is not determined"
                                      : "the boards' normals lie in one plane (out of it they vary by "
                                        "%.1f deg): the position across "
                                        "that plane is not determined",
                tilt * degrees),
      cure(flat_axis));
}

}  // namespace

Result<Observability> judge(const PairEvidence& evidence) {
  const std::string pair = evidence.camera + " - " + evidence.lidar;
  const auto count = static_cast<int>(evidence.normals.size());
  int flat_axis = 0;
  if (auto judged = judge_tilts(pair, evidence, flat_axis); !judged) return fail(judged.error());
  const double translation = std::sqrt(evidence.covariance.bottomRightCorner<3, 3>().trace());
  const double rotation = std::sqrt(evidence.covariance.topLeftCorner<3, 3>().trace());
  if (!std::isfinite(translation + rotation) || translation > max_sigma_translation ||
      rotation > max_sigma_rotation) {
    return fail(ErrorCode::refused, pair,
                formatted("these views leave %.0f mm and %.1f deg of uncertainty", translation * 1e3,
                          rotation * degrees),
                std::string(cure(flat_axis)) + "; more views and nearer ones help too");
  }
  // The right perturbation is in the LiDAR's axes; people think in the camera's.
  Matrix6d turn = Matrix6d::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = evidence.T_camera_lidar.R;
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(turn * evidence.covariance * turn.transpose());
  Observability result;
  const Vector6d weakest = eigen.eigenvectors().col(5);
  const bool is_rotation = weakest.head<3>().norm() > weakest.tail<3>().norm();
  result.weakest_direction =
      direction(is_rotation, largest_axis(is_rotation ? weakest.head<3>() : weakest.tail<3>()));
  result.condition = std::sqrt(eigen.eigenvalues()(5) / std::max(1e-300, eigen.eigenvalues()(0)));
  // With three views or less nothing is left over to check them by; with most views rejected, who is wrong?
  const bool checked = count >= 4 && 10 * count >= 6 * evidence.candidates;
  const bool certain = translation <= good_sigma_translation && rotation <= good_sigma_rotation;
  result.verdict = checked && certain ? "good" : "weak";
  return result;
}

}  // namespace ca2
