/// @file The daemon's status in words.
#pragma once

#include <string>

#include "messages/status.h"

namespace ca2 {

/// Several lines: state and why, every sensor, sigma against target, the next pose, what is wrong.
std::string status_text(const DaemonStatus& status);
/// One line, for a log.
std::string status_line(const DaemonStatus& status);

/// "running", "silent", "sees the board", ...: how a sensor does, in a word or two.
std::string sensor_word(const SensorStatus& sensor, const SensorHealth& health);
/// "sigma 1.2 mm, 0.8 mrad (target 2 mm, 1 mrad)"; what there is before the first answer.
std::string sigma_text(const CaptureStatus& capture);

}  // namespace ca2
