/// @file What a LiDAR's ranges are off by, ring by ring and on black and white.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace ca2 {

/// Systematic parts of the range errors, m, with mean zero over the returns they were estimated from: a
/// common part is the range bias. Real units show some 10 mm of both: every laser has its own offset, and
/// dark print is measured farther away than white paper. Left alone they bend every board and pull the answer
/// by far more than the noise.
struct RangeCorrection {
  std::vector<double> by_ring;  ///< measured minus true
  std::vector<double> by_bin;   ///< of RangeClasses
  /// The lasers' offsets have no part in `by_ring` that grows with the elevation: it would tilt every board
  /// alike, and only the rest of the calibration can tell it. By their spread it has this standard deviation,
  /// m per sine of the elevation; 0 where the lasers show no offsets.
  double slope_sigma = 0;

  /// Of a class of returns; -1: ring or bin not known.
  double at(int ring, int bin) const;
  /// The largest there is.
  double largest() const;
};

/// What returns are told apart by: their rings and, in bins, how much of what they hit is ink. That is known
/// from where they met the print. Their own intensities tell it less well: they change with distance and
/// incidence from board to board and over each, and an offset by intensity is then in part one by distance
/// and incidence, which the range bias cannot be told from.
struct RangeClasses {
  static constexpr int bins = 6;
  int rings = 0;  ///< rings 0 .. rings - 1; 0: not told apart

  bool tells(int ring) const { return ring >= 0 && ring < rings; }
  /// Of a share of ink, 0 .. 1.
  static int bin(double ink) { return std::clamp(static_cast<int>(bins * ink), 0, bins - 1); }
};

/// Sums over returns of one class, whose ranges are therefore off by the same: r is the residual (range less
/// the predicted range), J its derivative by the plane's inverse and the range slope (see RangeSums).
struct ClassSums {
  int ring = -1, bin = -1;  ///< -1: not known
  double count = 0;
  double r = 0;  ///< m
  Eigen::Vector4d J = Eigen::Vector4d::Zero();
};

/// The returns of one board.
struct CorrectionEvidence {
  std::vector<ClassSums> classes;
  Eigen::Matrix4d JJ = Eigen::Matrix4d::Zero();  ///< sums of J J' and r J over all
  Eigen::Vector4d rJ = Eigen::Vector4d::Zero();
  double rr = 0;  ///< sum of r^2
};

/// Estimates both parts together with a plane per board (eliminated), by regularised least squares: the sizes
/// of the offsets' priors, 16 mm at most, are those under which the data is most probable. Empty where the
/// residuals give no reason for it: chance alone explains them.
/// `sigma`: noise of one return, m.
RangeCorrection estimate_range_correction(const RangeClasses& classes,
                                          std::span<const CorrectionEvidence> boards, double sigma);

}  // namespace ca2
