/// @file What a LiDAR's ranges are off by, ring by ring and with the brightness of what they hit.
#pragma once

#include <span>
#include <vector>

#include "core/features/sights.h"

namespace ca2 {

/// Systematic parts of the range errors, m, with mean zero over the returns they were estimated from: a
/// common part is the range bias. Real units show some 10 mm of both: every laser has its own offset, and
/// dark print is measured farther away than white paper. Left alone they bend every board and pull the answer
/// by far more than the noise.
struct RangeCorrection {
  std::vector<double> by_ring;         ///< measured minus true
  std::vector<float> intensity_edges;  ///< rising; bin i holds intensities from edge i - 1 to edge i
  std::vector<double> by_intensity;    ///< one more than edges, or empty
  /// The lasers' offsets have no part in `by_ring` that grows with the elevation: it would tilt every board
  /// alike, and only the rest of the calibration can tell it. By their spread it has this standard deviation,
  /// m per sine of the elevation; 0 where the lasers show no offsets.
  double slope_sigma = 0;

  double at(const BoardReturn& here) const;
};

/// Divides the intensities of one board's returns by their highest decile: 1 is then the white of the paper,
/// whatever the distance and the incidence. Offsets by raw intensity would be offsets by distance.
void relate_to_white(std::vector<BoardReturn>& returns);

/// The returns of one board, for the estimate; intensities related to white.
struct CorrectionPatch {
  std::span<const BoardReturn> returns;
  Plane plane;  ///< near the best fit
};

/// Estimates both parts together with a plane per patch (eliminated), by regularised least squares: a laser's
/// offset is held to zero with a standard deviation of 16 mm at most. Empty where the residuals give no reason for
/// it: chance alone explains them, or rings and intensities are not known. `sigma`: noise of one return, m;
/// `gate`: m.
RangeCorrection estimate_range_correction(std::span<const CorrectionPatch> patches, double sigma,
                                          double gate);

}  // namespace ca2
