/// @file Reading the small text files that belong to a sensor.
#pragma once

#include <filesystem>
#include <string>

#include "core/types/result.h"

namespace ca2 {

/// A metadata or calibration file, whole; ErrorCode::io when it cannot be read, ErrorCode::data above 4 MiB.
Result<std::string> read_sensor_file(const std::filesystem::path& file);

}  // namespace ca2
