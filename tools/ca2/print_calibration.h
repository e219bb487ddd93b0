/// @file A calibration in words, for a terminal.
#pragma once

#include <string>

#include "core/session/calibration.h"

namespace ca2 {

std::string describe(const Calibration& calibration);

}  // namespace ca2
