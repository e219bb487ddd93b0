#include "core/solve/corner_noise.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace ca2 {
namespace {

constexpr double chi2_median_2 = 1.386;  // of chi-squared with 2 degrees of freedom

}  // namespace

double CornerNoise::add_view(const Board& board, std::span<const Eigen::Vector2d> positions,
                             const Camera& camera, const Pose& T_camera_board,
                             std::span<const Corner> corners) {
  const auto count = static_cast<Eigen::Index>(corners.size());
  Eigen::VectorXd errors = Eigen::VectorXd::Zero(2 * count);
  Eigen::Matrix<double, Eigen::Dynamic, 6> by_pose =
      Eigen::Matrix<double, Eigen::Dynamic, 6>::Zero(2 * count, 6);
  std::vector<Eigen::Vector2d> places;
  double sum = 0;
  ProjectionJacobian jacobian;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Corner& corner = corners[static_cast<std::size_t>(i)];
    places.push_back(positions[static_cast<std::size_t>(corner.id)]);
    const Eigen::Vector3d p_board(places.back().x(), places.back().y(), 0);
    const auto pixel = camera.project(T_camera_board * p_board, &jacobian);
    if (!pixel) continue;
    const Eigen::Vector2d e = *pixel - corner.pixel;
    sum += e.squaredNorm();
    const Eigen::LLT<Eigen::Matrix2d> whitening(corner.covariance);
    const Eigen::Matrix<double, 2, 3> by_point = whitening.matrixL().solve(jacobian.point);
    errors.segment<2>(2 * i) = whitening.matrixL().solve(e);
    by_pose.block<2, 3>(2 * i, 0) = -by_point * T_camera_board.R * skew(p_board);
    by_pose.block<2, 3>(2 * i, 3) = by_point * T_camera_board.R;
  }
  // What another board pose would take away is the LiDAR's pull, not the corners' error.
  errors -= by_pose * by_pose.colPivHouseholderQr().solve(errors);
  std::vector<Eigen::Vector2d> whitened;
  for (Eigen::Index i = 0; i < count; ++i) {
    whitened.emplace_back(errors.segment<2>(2 * i));
    squares_.push_back(whitened.back().squaredNorm());
  }
  views_ += 1;
  for (std::size_t i = 0; i < places.size(); ++i) {
    for (std::size_t k = i + 1; k < places.size(); ++k) {
      if ((places[i] - places[k]).norm() > 1.2 * board.square) continue;
      // Clipped, so that a single bad corner does not decide.
      const auto clip = [](const Eigen::Vector2d& e) {
        return Eigen::Vector2d(e * std::min(1.0, 20 / (e.norm() + 1e-9)));
      };
      const Eigen::Vector2d a = clip(whitened[i]);
      const Eigen::Vector2d b = clip(whitened[k]);
      products_ += a.dot(b);
      energy_ += 0.5 * (a.squaredNorm() + b.squaredNorm());
      pairs_ += 1;
    }
  }
  return std::sqrt(sum / std::max<double>(1, static_cast<double>(corners.size())));
}

std::optional<double> CornerNoise::scale() const {
  const double count = static_cast<double>(squares_.size());
  const double freedom = 2 * count - 6 * views_;
  if (freedom < 10) return std::nullopt;
  // The median does not see the few bad corners.
  std::vector<double> squares = squares_;
  std::nth_element(squares.begin(), squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2),
                   squares.end());
  double variance = squares[squares.size() / 2] / chi2_median_2 * 2 * count / freedom;
  // A field whose neighbours correlate by r has as many independent parts as one (1 + r) / (1 - r) coarser
  // each way.
  const double correlation = energy_ > 0 ? products_ / energy_ : 0;
  if (correlation > 3 / std::sqrt(2 * pairs_ + 1)) {
    const double r = std::min(correlation, 0.9);
    variance *= std::pow((1 + r) / (1 - r), 2);
  }
  return std::max(1e-4, std::sqrt(variance));
}

}  // namespace ca2
