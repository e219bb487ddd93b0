/// @file Numbers of the T265's USB protocol. All values on the wire are little-endian and packed.
#pragma once

#include <chrono>
#include <cstdint>

#include "drivers/usb/usb_devices.h"

namespace ca2::t265 {

/// Without firmware, as it powers up: the boot loader of its Myriad 2 processor.
inline constexpr UsbId boot_id{0x03e7, 0x2150};
/// With firmware.
inline constexpr UsbId camera_id{0x8087, 0x0b37};
inline constexpr int interface = 0;                              ///< the only one of both
inline constexpr std::chrono::milliseconds udev_patience{2000};  ///< it comes and goes in our hands

// Endpoints of the camera.
inline constexpr std::uint8_t request_endpoint = 0x02, response_endpoint = 0x82;
inline constexpr std::uint8_t picture_endpoint = 0x81;  ///< bulk: pictures and events
inline constexpr std::uint8_t event_endpoint = 0x83;    ///< interrupt: motion, pose and events

/// Vendor request that restarts it: the boot loader comes back.
inline constexpr std::uint8_t reset_request = 0x10;

enum class Message : std::uint16_t {
  device_info = 0x0001,
  get_time = 0x0002,
  supported_streams = 0x0004,
  stream_control = 0x0005,
  camera_intrinsics = 0x0006,
  extrinsics = 0x0008,
  log_control = 0x000c,
  sample = 0x0011,
  start = 0x0012,
  stop = 0x0013,
  status = 0x0014,
  exposure_mode = 0x0016,
  set_exposure = 0x0017,
  low_power = 0x0025,
  pose_control = 0x1006,
  device_error = 0x8000,
  pose_error = 0x9000,
};

enum class Status : std::uint16_t {
  success = 0,
  unknown_message = 1,
  invalid_length = 2,
  invalid_parameter = 3,
  internal_error = 4,
  unsupported = 5,
  list_too_big = 6,
  more_data = 7,
  busy = 8,  ///< already started
  timeout = 9,
  table_missing = 0xa,
  table_locked = 0xb,
  stopped = 0xc,
  temperature_warning = 0x10,
  temperature_stop = 0x11,
  crc_error = 0x12,
  incompatible = 0x13,
  auth_error = 0x14,
  reset = 0x15,
};
/// "DEVICE_BUSY".
const char* name_of(Status status);

/// Kind of sensor in bits 0 to 4, which of them above.
enum class Sensor : std::uint8_t {
  left = 0x03,   ///< fisheye
  right = 0x23,  ///< fisheye
  gyro = 0x04,
  accelerometer = 0x05,
  pose = 0x0a,
};

inline constexpr std::uint32_t kannala_brandt4 = 4;  ///< the only distortion model fisheyes come with

inline constexpr int request_header = 6, response_header = 8;
inline constexpr int sample_header = 28;   ///< of every sample
inline constexpr int picture_header = 44;  ///< of a picture, sample_header included

}  // namespace ca2::t265
