/// @file The newest answer as an LCM message.
#pragma once

#include <cstdint>
#include <string>

#include "core/session/calibration.h"

namespace ca2 {

class extrinsics_v1_t;

/// `time`: ns UTC, when it was solved.
extrinsics_v1_t to_lcm(const Calibration& calibration, const std::string& session, std::int64_t time);

}  // namespace ca2
