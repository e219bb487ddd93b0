/// @file The T265's messages: requests to bytes, bytes to what they say. Pure; every length and count is
/// checked, because what comes over a cable may be anything.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "core/types/result.h"
#include "drivers/camera/t265/protocol.h"

namespace ca2::t265 {

using Bytes = std::vector<std::uint8_t>;
using ByteSpan = std::span<const std::uint8_t>;

/// A sensor's stream, as the device offers it and as it is asked for.
struct StreamEntry {
  Sensor sensor{};
  std::uint16_t width = 0, height = 0;
  std::uint8_t pixel_format = 0;  ///< 9: 8-bit grey
  std::uint8_t output = 0;        ///< 1: sent to the host
  std::uint16_t stride = 0;       ///< bytes
  std::uint16_t rate = 0;         ///< Hz

  bool operator==(const StreamEntry&) const = default;
};

struct DeviceInfo {
  std::string serial;    ///< as on its label: 12 hexadecimal digits
  std::string firmware;  ///< "0.2.0.951"
  std::uint32_t status = 0;
  bool calibrated() const { return status != 1000; }
};

struct CameraIntrinsics {
  std::uint32_t width = 0, height = 0;
  float cx = 0, cy = 0, fx = 0, fy = 0;  ///< px
  std::uint32_t model = 0;
  std::array<float, 5> coefficients{};  ///< k1 to k4; the fifth is not used
};

/// p_reference = R p_sensor + t.
struct Extrinsics {
  std::array<float, 9> R{};  ///< column by column, as sent
  std::array<float, 3> t{};  ///< m
  Sensor reference{};
};

Bytes request(Message message, ByteSpan body = {});
Bytes request_camera_intrinsics(Sensor imager);
Bytes request_extrinsics(Sensor sensor);
Bytes request_streams(std::span<const StreamEntry> streams);
Bytes request_log(std::uint8_t verbosity);
Bytes request_low_power(bool on);
Bytes request_pose(bool on);
/// `automatic`: for both imagers, without anti-flicker. Only before start.
Bytes request_exposure_mode(bool automatic);
/// The same for both imagers; `exposure` in us, 200 to 16000; `gain` 1 to 10.
Bytes request_exposure(std::uint32_t exposure, float gain);

struct Response {
  Message message{};
  Status status{};
  ByteSpan body;  ///< part of the bytes that were parsed
};

/// ErrorCode::data where the bytes are no whole response.
Result<Response> parse_response(ByteSpan bytes);
Result<DeviceInfo> parse_device_info(ByteSpan body);
/// ns since the device started.
Result<std::uint64_t> parse_time(ByteSpan body);
Result<std::vector<StreamEntry>> parse_streams(ByteSpan body);
Result<CameraIntrinsics> parse_camera_intrinsics(ByteSpan body);
Result<Extrinsics> parse_extrinsics(ByteSpan body);

/// A picture of one imager.
struct Picture {
  Sensor imager{};
  std::uint64_t time = 0;      ///< ns since the device started: the middle of the exposure
  std::uint64_t arrival = 0;   ///< ns since the device started: when its processor had it
  std::uint32_t number = 0;    ///< from 0; the same for what both imagers took at a time
  std::uint32_t exposure = 0;  ///< us
  float gain = 0;
  ByteSpan pixels;
};
/// Something happened.
struct Event {
  Message message{};
  Status status{};
};
/// A whole message that is of no interest here: motion, pose.
struct Other {};
/// No whole message.
struct Damaged {
  std::string what;
};
using StreamMessage = std::variant<Damaged, Picture, Event, Other>;

/// What one transfer of the picture or event endpoint brought.
StreamMessage parse_stream(ByteSpan bytes);

}  // namespace ca2::t265
