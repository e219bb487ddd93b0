/// @file May a set of views determine a camera? Each gate answers with what is missing and what to show next.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/intrinsics/estimate_intrinsics.h"

namespace ca2 {

/// Do the corners [px] reach enough of the picture?
std::optional<Problem> coverage_problem(const IntrinsicsGates& gates, int width, int height,
                                        std::span<const Eigen::Vector2d> corners);

/// Do the boards face different ways? Parallel boards leave the focal length open.
std::optional<Problem> tilt_problem(const IntrinsicsGates& gates, std::span<const Pose> poses);

/// Are focal length, principal point and the map from rays to pixels known well enough? Of a solved estimate.
std::optional<Problem> determination_problem(const IntrinsicsGates& gates,
                                             const IntrinsicsEstimate& estimate);

/// IntrinsicsEstimate::projection_sigma, px.
double projection_sigma(const Camera& camera, const Eigen::MatrixXd& covariance,
                        std::span<const Eigen::Vector2d> corners);

}  // namespace ca2
