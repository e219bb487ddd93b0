/// @file Search for the error that the returns of a view share.
#pragma once

#include <cmath>
#include <optional>

namespace ca2 {

/// Finds the error (m) with which a misfit is what chance explains, to about 1 %. A view's misfit falls as
/// 1 / (variance + error^2), so that the inverse of their sum is nearly straight over error^2: along the
/// chord, or halfway of what is left where that leads out of it.
class SharedErrorSearch {
 public:
  /// `share`: degrees of freedom over the misfit, here without any shared error.
  explicit SharedErrorSearch(double share) : last_share_(share) {}

  /// The error to try next; nothing: the last one is it.
  std::optional<double> next() const { return error_; }

  /// The share with that error; it rises with the error, and is 1 at the one looked for.
  void take(double share) {
    const double tried = *error_, square = tried * tried;
    (share < 1 ? low_ : high_) = tried;
    const double slope = (share - last_share_) / (square - last_square_);
    const double along = std::sqrt(square + (1 - share) / slope);
    last_square_ = square;
    last_share_ = share;
    const bool found = std::abs(std::log(along / tried)) < enough;
    if (found || ++tries_ == most_tries) {
      error_.reset();
    } else {
      error_ = along > low_ && along < high_ ? along : std::sqrt(low_ * high_);
    }
  }

 private:
  static constexpr double enough = 0.012;  // of the error, as a logarithm
  static constexpr int most_tries = 8;

  double low_ = 1e-4, high_ = 0.05;       ///< m
  std::optional<double> error_ = 0.5e-3;  ///< m: what LiDARs' returns share is of this order
  double last_square_ = 0, last_share_;
  int tries_ = 0;
};

}  // namespace ca2
