#include "drivers/camera/t265/messages.h"

#include "core/types/text.h"
#include "drivers/lidar/bytes.h"

namespace ca2::t265 {
namespace {

/// Bytes one after another.
class Writer {
 public:
  template <class T>
  Writer& put(T value) {
    bytes_.resize(bytes_.size() + sizeof value);
    store(bytes_.data() + bytes_.size() - sizeof value, value);
    return *this;
  }
  ByteSpan bytes() const { return bytes_; }

 private:
  Bytes bytes_;
};

std::uint8_t id(Sensor sensor) {
  return static_cast<std::uint8_t>(sensor);
}

tl::unexpected<Error> wrong_length(const char* what, std::size_t got, std::size_t expected) {
  return fail(ErrorCode::data, "T265", formatted("%s of %zu bytes, not %zu", what, got, expected));
}

}  // namespace

const char* name_of(Status status) {
  switch (status) {
    case Status::success:
      return "SUCCESS";
    case Status::unknown_message:
      return "UNKNOWN_MESSAGE_ID";
    case Status::invalid_length:
      return "INVALID_REQUEST_LEN";
    case Status::invalid_parameter:
      return "INVALID_PARAMETER";
    case Status::internal_error:
      return "INTERNAL_ERROR";
    case Status::unsupported:
      return "UNSUPPORTED";
    case Status::list_too_big:
      return "LIST_TOO_BIG";
    case Status::more_data:
      return "MORE_DATA_AVAILABLE";
    case Status::busy:
      return "DEVICE_BUSY";
    case Status::timeout:
      return "TIMEOUT";
    case Status::table_missing:
      return "TABLE_NOT_EXIST";
    case Status::table_locked:
      return "TABLE_LOCKED";
    case Status::stopped:
      return "DEVICE_STOPPED";
    case Status::temperature_warning:
      return "TEMPERATURE_WARNING";
    case Status::temperature_stop:
      return "TEMPERATURE_STOP";
    case Status::crc_error:
      return "CRC_ERROR";
    case Status::incompatible:
      return "INCOMPATIBLE";
    case Status::auth_error:
      return "AUTH_ERROR";
    case Status::reset:
      return "DEVICE_RESET";
  }
  return "a status that is not known";
}

Bytes request(Message message, ByteSpan body) {
  Bytes out(request_header + body.size());
  store(out.data(), static_cast<std::uint32_t>(out.size()));
  store(out.data() + 4, static_cast<std::uint16_t>(message));
  std::copy(body.begin(), body.end(), out.begin() + request_header);
  return out;
}

Bytes request_camera_intrinsics(Sensor imager) {
  return request(Message::camera_intrinsics, Writer().put(id(imager)).bytes());
}

Bytes request_extrinsics(Sensor sensor) {
  return request(Message::extrinsics, Writer().put(id(sensor)).bytes());
}

Bytes request_streams(std::span<const StreamEntry> streams) {
  Writer body;
  body.put(static_cast<std::uint16_t>(streams.size()));
  for (const StreamEntry& s : streams) {
    body.put(id(s.sensor)).put(std::uint8_t{0}).put(s.width).put(s.height);
    body.put(s.pixel_format).put(s.output).put(s.stride).put(s.rate);
  }
  return request(Message::stream_control, body.bytes());
}

Bytes request_log(std::uint8_t verbosity) {
  const std::uint8_t roll_over = 1;
  return request(Message::log_control, Writer().put(verbosity).put(roll_over).bytes());
}

Bytes request_low_power(bool on) {
  return request(Message::low_power, Writer().put(std::uint8_t{on}).put(std::uint8_t{0}).bytes());
}

Bytes request_pose(bool on) {
  const std::uint8_t mode = 0;
  return request(Message::pose_control, Writer().put(std::uint8_t{on}).put(mode).bytes());
}

Bytes request_exposure_mode(bool automatic) {
  const std::uint8_t imagers = automatic ? 3 : 0, anti_flicker = 0;
  return request(Message::exposure_mode, Writer().put(imagers).put(anti_flicker).bytes());
}

Bytes request_exposure(std::uint32_t exposure, float gain) {
  Writer body;
  body.put(std::uint8_t{2}).put(std::uint8_t{0});
  for (const Sensor imager : {Sensor::left, Sensor::right}) {
    body.put(id(imager)).put(std::uint8_t{0}).put(std::uint16_t{0}).put(exposure).put(gain);
  }
  return request(Message::set_exposure, body.bytes());
}

Result<Response> parse_response(ByteSpan bytes) {
  if (bytes.size() < response_header) return wrong_length("a response", bytes.size(), response_header);
  const auto length = load<std::uint32_t>(bytes.data());
  if (length != bytes.size()) return wrong_length("a response", bytes.size(), length);
  Response out;
  out.message = static_cast<Message>(load<std::uint16_t>(bytes.data() + 4));
  out.status = static_cast<Status>(load<std::uint16_t>(bytes.data() + 6));
  out.body = bytes.subspan(response_header);
  return out;
}

Result<DeviceInfo> parse_device_info(ByteSpan body) {
  if (body.size() != 46) return wrong_length("device information", body.size(), 46);
  DeviceInfo out;
  out.firmware = formatted("%d.%d.%d.%u", body[5], body[6], body[7], load<std::uint32_t>(body.data() + 8));
  out.status = load<std::uint32_t>(body.data() + 16);
  for (int i = 24; i < 30; ++i) out.serial += formatted("%02X", body[static_cast<std::size_t>(i)]);
  return out;
}

Result<std::uint64_t> parse_time(ByteSpan body) {
  if (body.size() != 8) return wrong_length("a time", body.size(), 8);
  return load<std::uint64_t>(body.data());
}

Result<std::vector<StreamEntry>> parse_streams(ByteSpan body) {
  if (body.size() < 4) return wrong_length("a list of streams", body.size(), 4);
  const std::size_t count = load<std::uint16_t>(body.data());
  if (body.size() != 4 + 12 * count) return wrong_length("a list of streams", body.size(), 4 + 12 * count);
  std::vector<StreamEntry> out;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint8_t* entry = body.data() + 4 + 12 * i;
    out.push_back({static_cast<Sensor>(entry[0]), load<std::uint16_t>(entry + 2),
                   load<std::uint16_t>(entry + 4), entry[6], entry[7], load<std::uint16_t>(entry + 8),
                   load<std::uint16_t>(entry + 10)});
  }
  return out;
}

Result<CameraIntrinsics> parse_camera_intrinsics(ByteSpan body) {
  if (body.size() != 48) return wrong_length("intrinsics", body.size(), 48);
  const std::uint8_t* b = body.data();
  CameraIntrinsics out;
  out.width = load<std::uint32_t>(b);
  out.height = load<std::uint32_t>(b + 4);
  out.cx = load<float>(b + 8);
  out.cy = load<float>(b + 12);
  out.fx = load<float>(b + 16);
  out.fy = load<float>(b + 20);
  out.model = load<std::uint32_t>(b + 24);
  out.coefficients = load<std::array<float, 5>>(b + 28);
  return out;
}

Result<Extrinsics> parse_extrinsics(ByteSpan body) {
  if (body.size() != 49) return wrong_length("extrinsics", body.size(), 49);
  Extrinsics out;
  out.R = load<std::array<float, 9>>(body.data());
  out.t = load<std::array<float, 3>>(body.data() + 36);
  out.reference = static_cast<Sensor>(body[48]);
  return out;
}

namespace {

StreamMessage parse_picture(ByteSpan bytes) {
  if (bytes.size() < picture_header) return Damaged{"a picture without its header"};
  const std::uint8_t* b = bytes.data();
  if (load<std::uint32_t>(b + 28) != 8) return Damaged{"metadata of another layout"};
  const std::size_t size = load<std::uint32_t>(b + 40);
  if (size == 0 || size != bytes.size() - picture_header) {
    return Damaged{formatted("a picture of %zu bytes with %zu", size, bytes.size() - picture_header)};
  }
  Picture out;
  out.imager = static_cast<Sensor>(b[6]);
  out.time = load<std::uint64_t>(b + 8);
  out.arrival = load<std::uint64_t>(b + 16);
  out.number = load<std::uint32_t>(b + 24);
  out.exposure = load<std::uint32_t>(b + 32);
  out.gain = load<float>(b + 36);
  out.pixels = bytes.subspan(picture_header);
  return out;
}

}  // namespace

StreamMessage parse_stream(ByteSpan bytes) {
  if (bytes.size() < request_header) return Damaged{"a message without its header"};
  const std::size_t length = load<std::uint32_t>(bytes.data());
  if (length != bytes.size()) {
    return Damaged{formatted("a message of %zu bytes with %zu", length, bytes.size())};
  }
  const auto message = static_cast<Message>(load<std::uint16_t>(bytes.data() + 4));
  switch (message) {
    case Message::sample:
      if (bytes.size() < sample_header) return Damaged{"a sample without its header"};
      // Motion comes as samples too.
      if (bytes[6] != id(Sensor::left) && bytes[6] != id(Sensor::right)) return Other{};
      return parse_picture(bytes);
    case Message::status:
    case Message::device_error:
    case Message::pose_error:
      if (bytes.size() < request_header + 2) return Damaged{"an event without its code"};
      return Event{message, static_cast<Status>(load<std::uint16_t>(bytes.data() + request_header))};
    default:
      return Other{};
  }
}

}  // namespace ca2::t265
