/// @file Simulated features as the estimator takes them.
#pragma once

#include <vector>

#include "core/features/sights.h"
#include "core/session/rig.h"
#include "tools/sim/feature_simulator.h"

namespace ca2 {

/// The rig as a user would describe it: the scenario's sensors with their true intrinsics.
Rig rig_of(const Scenario& scenario);

/// The views' features with the rig's (possibly wrong) intrinsics: board poses from the corners, planes from
/// the returns. Sensors are indexed in the rig's order.
Result<std::vector<ViewSights>> sights_of(const Rig& rig, const std::vector<SimulatedView>& views);

/// The same views with planes only: nothing of the plate's rim.
std::vector<ViewSights> without_crossings(std::vector<ViewSights> views);

}  // namespace ca2
