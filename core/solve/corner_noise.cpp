#include "core/solve/corner_noise.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace ca2 {
namespace {

constexpr double chi2_median_2 = 1.386;  // of chi-squared with 2 degrees of freedom

}  // namespace

NeighbourTable neighbouring_corners(std::span<const Eigen::Vector2d> positions, double distance) {
  NeighbourTable table(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    for (std::size_t k = i + 1; k < positions.size(); ++k) {
      if ((positions[i] - positions[k]).norm() <= distance) table[i].push_back(static_cast<int>(k));
    }
  }
  return table;
}

void CornerNoise::add_view(const CornerField& corners, const Eigen::Matrix2Xd& errors,
                           const NeighbourTable& neighbours) {
  std::vector<Eigen::Index> place(neighbours.size(), -1);  // by id
  Eigen::Matrix2Xd clipped = errors;
  for (Eigen::Index i = 0; i < errors.cols(); ++i) {
    const double squared = errors.col(i).squaredNorm();
    squares_.push_back(squared);
    // So that a single bad corner does not decide.
    clipped.col(i) *= std::min(1.0, 20 / (std::sqrt(squared) + 1e-9));
    place[static_cast<std::size_t>(corners.id(static_cast<std::size_t>(i)))] = i;
  }
  views_ += 1;
  for (std::size_t id = 0; id < neighbours.size(); ++id) {
    if (place[id] < 0) continue;
    for (const int other : neighbours[id]) {
      const Eigen::Index k = place[static_cast<std::size_t>(other)];
      if (k < 0) continue;
      products_ += clipped.col(place[id]).dot(clipped.col(k));
      energy_ += 0.5 * (clipped.col(place[id]).squaredNorm() + clipped.col(k).squaredNorm());
      pairs_ += 1;
    }
  }
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
