/// @file The controls of a V4L2 camera, by the names that V4L2's own tools print.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/types/result.h"
#include "drivers/camera/camera_source.h"
#include "drivers/camera/v4l2/device.h"

namespace ca2 {

/// "brightness", "gain", "focus_absolute", ...; and "exposure_us" (microseconds or "auto") for
/// exposure_time_absolute with its switch.
class V4l2Controls {
 public:
  explicit V4l2Controls(const V4l2Device& device);

  /// As they are now.
  std::map<std::string, CameraControl> read() const;
  /// Is this control there, and the value within its limits? ErrorCode::usage.
  Result<void> check(const std::string& name, const std::string& value) const;
  /// Writes what check() let pass; automatics that would overrule a value are switched off first.
  Result<void> write(const std::string& name, const std::string& value) const;
  /// Several: automatics before values.
  Result<void> write(const std::map<std::string, std::string>& values) const;

  /// s; 0: automatic or not told.
  double exposure() const;

 private:
  struct Entry {
    std::uint32_t id = 0, type = 0;
    std::int64_t least = 0, most = 0, step = 1;
  };
  const Entry* find(std::uint32_t id) const;
  Result<void> set(const std::string& name, std::uint32_t id, std::int64_t value) const;
  bool get(std::uint32_t id, std::int64_t& value) const;
  Result<void> write_exposure(const std::string& value) const;

  const V4l2Device& device_;
  std::map<std::string, Entry> entries_;  ///< by name
};

}  // namespace ca2
