/// @file One open USB device with one claimed interface, through libusb.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <thread>

#include "core/types/result.h"
#include "drivers/usb/usb_devices.h"

struct libusb_device_handle;

namespace ca2 {

/// How a transfer ended. All of these happen with real devices and are answers, not errors.
enum class UsbOutcome {
  done,
  timeout,
  gone,      ///< unplugged, or fallen off the bus
  stalled,   ///< the device refused
  overflow,  ///< the device sent more than there was room for
  failed,
};
const char* text_of(UsbOutcome outcome);
/// Of a libusb error code; 0 and above: done.
UsbOutcome usb_outcome(int code);

struct UsbTransfer {
  UsbOutcome outcome = UsbOutcome::failed;
  std::size_t size = 0;  ///< bytes that went over, also when it did not end well
};

/// Transfers of different endpoints may run in different threads; of one endpoint, in one at a time.
class UsbDevice {
 public:
  /// Opens the device that is at that place and address and claims its interface `interface`, taking it from
  /// a kernel driver. `unavailable`: it is gone, or another program has it; `no_permission`, tried again for
  /// `patience`: udev gives a device that has just come its permissions a moment later.
  static Result<std::unique_ptr<UsbDevice>> open(const UsbDeviceInfo& info, int interface,
                                                 std::chrono::milliseconds patience);
  UsbDevice(const UsbDevice&) = delete;
  UsbDevice& operator=(const UsbDevice&) = delete;
  ~UsbDevice();

  const UsbDeviceInfo& info() const { return info_; }

  /// `endpoint` as in the descriptors: IN endpoints have bit 7 set.
  UsbTransfer write(std::uint8_t endpoint, std::span<const std::uint8_t> bytes, std::chrono::milliseconds);
  UsbTransfer read(std::uint8_t endpoint, std::span<std::uint8_t> bytes, std::chrono::milliseconds);
  /// A vendor request to the device that carries no data.
  UsbTransfer vendor_request(std::uint8_t request, std::chrono::milliseconds);

  /// The first bulk OUT endpoint of the claimed interface; 0 when it has none.
  std::uint8_t first_bulk_out() const;
  bool has_endpoint(std::uint8_t endpoint) const;

  libusb_device_handle* handle() const { return handle_; }

 private:
  UsbDevice(UsbDeviceInfo info, std::shared_ptr<libusb_context> context, libusb_device_handle* handle,
            int interface);

  UsbDeviceInfo info_;
  std::shared_ptr<libusb_context> context_;
  libusb_device_handle* handle_;
  int interface_;
  std::atomic<bool> closing_{false};
  std::thread events_;  ///< runs the completions of UsbReader
};

}  // namespace ca2
