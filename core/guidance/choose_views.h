/// @file The best few of many views.
#pragma once

#include <cstddef>
#include <vector>

#include "core/guidance/view_information.h"

namespace ca2 {

/// Indices, rising, of the `count` views whose information together with `prior` gives the lowest
/// expected_sigma().cost: the best of several greedy beginnings, then exchanges as long as one helps. All of
/// them where there are no more. Deterministic.
std::vector<std::size_t> choose_views(const std::vector<PairInformation>& views, std::size_t count,
                                      const PairInformation& prior, const SigmaTarget& target);

}  // namespace ca2
