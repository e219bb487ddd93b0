/// @file Which USB devices are connected, and where.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/types/result.h"

struct libusb_context;

namespace ca2 {

struct UsbId {
  std::uint16_t vendor = 0, product = 0;
  bool operator==(const UsbId&) const = default;
};

struct UsbDeviceInfo {
  UsbId id;
  std::string port;          ///< place, "2-1.3": bus, then ports
  std::uint8_t address = 0;  ///< on its bus; a new one each time it comes back
  int megabits = 0;          ///< per second, of the connection; 0: unknown
  std::string serial;        ///< its serial number string; empty when it has none

  bool operator==(const UsbDeviceInfo&) const = default;
};

/// A libusb context of one's own: an old one does not learn of new devices where no udev daemon runs.
Result<std::shared_ptr<libusb_context>> new_usb_context();

/// The devices with one of these ids, by place. No traffic to them and no permission is needed.
Result<std::vector<UsbDeviceInfo>> list_usb_devices(std::span<const UsbId> ids);

}  // namespace ca2
