/// @file The plot of `ca2 bench accuracy`.
#pragma once

#include <string>
#include <vector>

#include "tools/ca2/bench_accuracy_trials.h"

namespace ca2 {

/// Mean translation error of every method and the bounds over the number of views, both axes logarithmic: one
/// frame per experiment, side by side, as one SVG picture. Cells of an experiment follow each other.
std::string accuracy_plot(const std::vector<AccuracyCell>& cells);

}  // namespace ca2
