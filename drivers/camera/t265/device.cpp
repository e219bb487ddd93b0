#include "drivers/camera/t265/device.h"

#include <algorithm>
#include <thread>

#include "core/types/text.h"

namespace ca2::t265 {
namespace {

using std::chrono::milliseconds, std::chrono::seconds;
using Clock = std::chrono::steady_clock;

/// The longest response is the list of streams, some hundred bytes; a multiple of the packet size.
constexpr std::size_t longest_response = 64 * 1024;
constexpr milliseconds patience = seconds(2);
constexpr std::uint8_t grey8 = 9;    // pixel format
constexpr std::uint8_t to_host = 1;  // output mode

}  // namespace

Error Device::failed(ErrorCode code, const char* what, const std::string& why) const {
  return {code, "T265, USB " + usb_->info().port, std::string("cannot ") + what + ": " + why};
}

void Device::drain() {
  Bytes waste(1u << 20);
  for (const std::uint8_t endpoint : {response_endpoint, picture_endpoint, event_endpoint}) {
    // Bounded: a device that never stops sending has another problem, which the first request will show.
    for (int i = 0; i < 16; ++i) {
      const UsbTransfer got = usb_->read(endpoint, waste, milliseconds(20));
      if (got.outcome != UsbOutcome::done) break;
    }
  }
}

Result<std::unique_ptr<Device>> Device::open(const UsbDeviceInfo& place) {
  auto usb = UsbDevice::open(place, interface, udev_patience);
  if (!usb) return fail(usb.error());
  std::unique_ptr<Device> out(new Device(std::move(*usb)));
  for (const std::uint8_t endpoint :
       {request_endpoint, response_endpoint, picture_endpoint, event_endpoint}) {
    if (!out->usb_->has_endpoint(endpoint)) {
      return fail(out->failed(ErrorCode::unavailable, "use the device",
                              formatted("it has no endpoint 0x%02x", endpoint)));
    }
  }
  out->drain();
  // Whatever it says to this: it says something.
  if (const auto awake = out->exchange("wake the device", request_low_power(false), patience); !awake) {
    return fail(awake.error());
  }
  const auto answer = out->ask("read the device's information", request(Message::device_info));
  if (!answer) return fail(answer.error());
  const auto info = parse_device_info(answer->body);
  if (!info) return fail(info.error());
  out->info_ = *info;
  if (!info->calibrated()) {
    return fail(out->failed(ErrorCode::unavailable, "use the device", "it has lost its factory calibration"));
  }
  // Errors only, so that its log does not fill.
  const auto log = out->ask("set its log", request_log(1));
  if (!log) return fail(log.error());
  return out;
}

Result<Device::Answer> Device::exchange(const char* what, const Bytes& request, milliseconds timeout) {
  const std::lock_guard lock(mutex_);
  const auto asked = static_cast<Message>(request[4] | request[5] << 8);
  Answer out;
  out.sent = Clock::now();
  const UsbTransfer sent = usb_->write(request_endpoint, request, timeout);
  if (sent.outcome != UsbOutcome::done || sent.size != request.size()) {
    return fail(failed(sent.outcome == UsbOutcome::gone ? ErrorCode::unavailable : ErrorCode::io, what,
                       text_of(sent.outcome)));
  }
  Bytes buffer(longest_response);
  const auto deadline = out.sent + timeout;
  std::string last = text_of(UsbOutcome::timeout);
  for (;;) {
    const auto left = std::chrono::ceil<milliseconds>(deadline - Clock::now());
    // libusb takes 0 for "no limit".
    if (left.count() <= 0) return fail(failed(ErrorCode::io, what, last));
    const UsbTransfer got = usb_->read(response_endpoint, buffer, left);
    out.received = Clock::now();
    if (got.outcome == UsbOutcome::timeout) return fail(failed(ErrorCode::io, what, last));
    if (got.outcome != UsbOutcome::done) {
      return fail(failed(got.outcome == UsbOutcome::gone ? ErrorCode::unavailable : ErrorCode::io, what,
                         text_of(got.outcome)));
    }
    const auto response = parse_response(ByteSpan(buffer).first(got.size));
    if (!response) {
      last = response.error().problems[0].what;
      continue;
    }
    // The answer to an earlier request that was given up.
    if (response->message != asked) {
      last = formatted("it answered to message 0x%04x", static_cast<unsigned>(response->message));
      continue;
    }
    out.status = response->status;
    out.body.assign(response->body.begin(), response->body.end());
    return out;
  }
}

Result<Device::Answer> Device::ask(const char* what, const Bytes& request) {
  auto answer = exchange(what, request, patience);
  if (!answer) return answer;
  if (answer->status != Status::success) {
    return fail(failed(ErrorCode::unavailable, what,
                       formatted("%s (%u)", name_of(answer->status), static_cast<unsigned>(answer->status))));
  }
  return answer;
}

Result<FisheyeCalibration> Device::calibration(Sensor imager) {
  const auto intrinsics = ask("read the factory intrinsics", request_camera_intrinsics(imager));
  if (!intrinsics) return fail(intrinsics.error());
  const auto extrinsics = ask("read the factory extrinsics", request_extrinsics(imager));
  if (!extrinsics) return fail(extrinsics.error());
  const auto in = parse_camera_intrinsics(intrinsics->body);
  if (!in) return fail(in.error());
  const auto ex = parse_extrinsics(extrinsics->body);
  if (!ex) return fail(ex.error());
  return FisheyeCalibration{*in, *ex};
}

Result<std::vector<StreamEntry>> Device::fisheye_streams() {
  const char* what = "list its streams";
  const auto answer = ask(what, request(Message::supported_streams));
  if (!answer) return fail(answer.error());
  const auto offered = parse_streams(answer->body);
  if (!offered) return fail(offered.error());
  std::vector<StreamEntry> out;
  for (const Sensor imager : {Sensor::left, Sensor::right}) {
    const auto entry = std::find_if(offered->begin(), offered->end(), [&](const StreamEntry& s) {
      return s.sensor == imager && s.pixel_format == grey8 && s.stride == s.width;
    });
    if (entry == offered->end()) {
      return fail(failed(ErrorCode::unavailable, what, "no 8-bit grey stream of both fisheyes"));
    }
    out.push_back(*entry);
    out.back().output = to_host;
  }
  return out;
}

Result<void> Device::configure(std::span<const StreamEntry> streams, bool automatic_exposure) {
  // A device that an earlier program left running answers BUSY: it is stopped, which takes it a while.
  for (int attempt = 0;; ++attempt) {
    const auto answer = exchange("choose its streams", request_streams(streams), patience);
    if (!answer) return fail(answer.error());
    if (answer->status == Status::success) break;
    if (answer->status != Status::busy || attempt == 5) {
      return fail(failed(ErrorCode::unavailable, "choose its streams", name_of(answer->status)));
    }
    if (const auto stopped = stop(); !stopped) return stopped;
    std::this_thread::sleep_for(seconds(1));
    // Pictures of before, and the word that it has stopped.
    drain();
  }
  const auto mode = ask("set the exposure mode", request_exposure_mode(automatic_exposure));
  if (!mode) return fail(mode.error());
  const auto pose = ask("switch off tracking", request_pose(false));
  if (!pose) return fail(pose.error());
  return {};
}

Result<void> Device::start() {
  const auto answer = ask("start it", request(Message::start));
  if (!answer) return fail(answer.error());
  return {};
}

Result<void> Device::stop() {
  const auto answer = exchange("stop it", request(Message::stop), patience);
  if (!answer) return fail(answer.error());
  return {};
}

Result<TimeReading> Device::time() {
  const auto answer = ask("read its clock", request(Message::get_time));
  if (!answer) return fail(answer.error());
  const auto device = parse_time(answer->body);
  if (!device) return fail(device.error());
  return TimeReading{*device, answer->sent, answer->received};
}

Result<void> Device::set_exposure(std::uint32_t exposure, float gain) {
  const auto answer = ask("set the exposure", request_exposure(exposure, gain));
  if (!answer) return fail(answer.error());
  return {};
}

}  // namespace ca2::t265
