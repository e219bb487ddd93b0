/// @file Requests to a booted T265 and their answers.
#pragma once

#include <chrono>
#include <memory>
#include <mutex>

#include "drivers/camera/t265/calibration.h"
#include "drivers/camera/t265/messages.h"
#include "drivers/usb/usb_device.h"

namespace ca2::t265 {

/// A device time and when it was read. It lies somewhere between `sent` and `received`.
struct TimeReading {
  std::uint64_t device = 0;  ///< ns
  std::chrono::steady_clock::time_point sent, received;
};

/// Any thread may ask; requests go one after another.
class Device {
 public:
  /// Opens the device, throws away what an earlier program left unread, wakes it and asks who it is.
  /// ErrorCode::io: it is there but does not answer; a reset may help.
  static Result<std::unique_ptr<Device>> open(const UsbDeviceInfo& place);

  UsbDevice& usb() { return *usb_; }
  const DeviceInfo& info() const { return info_; }

  Result<FisheyeCalibration> calibration(Sensor imager);
  /// Both fisheyes as the device offers them, and nothing else; it would not serve one alone.
  Result<std::vector<StreamEntry>> fisheye_streams();
  /// Sets everything up; the device forgets it when it stops.
  Result<void> configure(std::span<const StreamEntry> streams, bool automatic_exposure);
  Result<void> start();
  Result<void> stop();
  Result<TimeReading> time();
  /// For both imagers; us, 200 to 16000, and a factor, 1 to 10. Not while exposure is automatic.
  Result<void> set_exposure(std::uint32_t exposure, float gain);

 private:
  struct Answer {
    Status status{};
    Bytes body;
    std::chrono::steady_clock::time_point sent, received;
  };

  explicit Device(std::unique_ptr<UsbDevice> usb) : usb_(std::move(usb)) {}

  void drain();
  /// The response to a request, whatever status it has. `what` is for errors: "cannot " + what.
  Result<Answer> exchange(const char* what, const Bytes& request, std::chrono::milliseconds timeout);
  /// Only SUCCESS.
  Result<Answer> ask(const char* what, const Bytes& request);
  Error failed(ErrorCode code, const char* what, const std::string& why) const;

  std::unique_ptr<UsbDevice> usb_;
  DeviceInfo info_;
  std::mutex mutex_;  ///< one request at a time
};

}  // namespace ca2::t265
