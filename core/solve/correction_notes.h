/// @file In words: what of the given the views contradicted, and what it was corrected to.
#pragma once

#include <string>
#include <vector>

#include "core/features/sights.h"
#include "core/session/calibration.h"
#include "core/session/rig.h"
#include "core/solve/joint_solver.h"

namespace ca2 {

/// One note for every lens, for the print and for the rims, where they were estimated; empty where all was
/// believed.
/// `views`: their sensors in the rig's order (by name).
std::vector<std::string> correction_notes(const Rig& rig, const std::vector<ViewSights>& views,
                                          const JointAnswer& answer, const CalibratedPrint& print);

}  // namespace ca2
