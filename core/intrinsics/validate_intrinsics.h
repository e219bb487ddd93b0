/// @file How well estimated intrinsics foretell views they have not seen.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/intrinsics/estimate_intrinsics.h"

namespace ca2 {

/// Cross validation: every view in turn, in `folds` groups, is kept from the estimate and then asked where
/// its corners are, the board placed freely. Root mean square over both coordinates of all corners, px;
/// nothing where some group's rest does not determine the camera. Deterministic.
std::optional<double> held_out_error(const Board& board, int width, int height, std::string_view model,
                                     std::span<const std::vector<Corner>> views, int folds = 5);

/// One model's answer to the same views.
struct IntrinsicsTrial {
  std::string model;
  Result<IntrinsicsEstimate> estimate;
  std::optional<double> held_out;  ///< px
};

/// Estimates each of the models.
std::vector<IntrinsicsTrial> try_models(const Board& board, int width, int height,
                                        const std::vector<std::string>& models,
                                        std::span<const std::vector<Corner>> views);

/// The model to take: the least held-out error; of those within 2 % of it, which chance makes, the one with
/// the fewest parameters. nullptr where none has an estimate.
const IntrinsicsTrial* best_trial(const std::vector<IntrinsicsTrial>& trials);

}  // namespace ca2
