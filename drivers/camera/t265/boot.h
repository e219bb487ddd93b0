/// @file From a T265 as it powers up to one that answers.
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "core/types/result.h"
#include "drivers/usb/usb_devices.h"

namespace ca2::t265 {

/// T265s that are connected, with and without firmware, by place.
Result<std::vector<UsbDeviceInfo>> list_devices();

/// Sends the firmware to a boot loader and waits until the camera has come up at the same place, at most
/// `patience`. It takes about two seconds.
Result<UsbDeviceInfo> boot(const UsbDeviceInfo& loader, const std::string& firmware,
                           std::chrono::milliseconds patience = std::chrono::seconds(10));

/// Restarts a camera and waits for its boot loader at the same place, at most `patience`.
Result<UsbDeviceInfo> reset(const UsbDeviceInfo& camera,
                            std::chrono::milliseconds patience = std::chrono::seconds(10));

}  // namespace ca2::t265
