#include "core/solve/corner_noise.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace ca2 {
namespace {

constexpr double chi2_median_2 = 1.386;  // of chi-squared with 2 degrees of freedom

}  // namespace

double CornerNoise::add_view(const Board& board, std::span<const Eigen::Vector2d> positions,
                             const Camera& camera, const Pose& T_camera_board,
                             std::span<const Corner> corners) {
  std::vector<Eigen::Vector2d> whitened;
  std::vector<Eigen::Vector2d> places;
  double sum = 0;
  for (const Corner& corner : corners) {
    const Eigen::Vector2d& xy = positions[static_cast<std::size_t>(corner.id)];
    const auto pixel = camera.project(T_camera_board * Eigen::Vector3d(xy.x(), xy.y(), 0));
    if (!pixel) continue;
    const Eigen::Vector2d e = *pixel - corner.pixel;
    whitened.emplace_back(corner.covariance.llt().matrixL().solve(e));
    places.push_back(xy);
    squares_.push_back(whitened.back().squaredNorm());
    sum += e.squaredNorm();
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
