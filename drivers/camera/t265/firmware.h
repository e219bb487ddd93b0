/// @file The T265's firmware: the device forgets it without power, so the host brings it every time.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "core/types/result.h"

namespace ca2::t265 {

/// Of target-0.2.0.951.mvcmd, the last release.
inline constexpr std::string_view firmware_sha1 = "c3940ccbb0e3045603e4aceaa2d73427f96e24bc";

/// Where the file comes from: for errors and documentation.
std::string firmware_hint();

/// The file's bytes, if their SHA-1 is `sha1` (hexadecimal, either case). ErrorCode::config else: an unknown
/// file is not sent into a device.
Result<std::string> read_firmware(const std::filesystem::path& file, std::string_view sha1 = firmware_sha1);

}  // namespace ca2::t265
