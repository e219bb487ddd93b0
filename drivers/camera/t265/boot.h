/// @file From a T265 as it powers up to one that answers.
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "core/types/result.h"
#include "drivers/usb/usb_devices.h"

namespace ca2::t265 {

/// T265s that are connected, with and without firmware, by place. The place of one changes with its firmware:
/// the boot loader is a USB 2 device, the camera one of USB 3, and a connector is two ports, on two buses.
Result<std::vector<UsbDeviceInfo>> list_devices();

/// Sends the firmware to a boot loader and waits until a camera has come up that was not there before, at
/// most `patience`. It takes about two seconds. Where several are booted at a time it may be another's.
Result<UsbDeviceInfo> boot(const UsbDeviceInfo& loader, const std::string& firmware,
                           std::chrono::milliseconds patience = std::chrono::seconds(10));

/// Restarts a camera and waits until a boot loader has come up that was not there before, at most `patience`.
Result<void> reset(const UsbDeviceInfo& camera,
                   std::chrono::milliseconds patience = std::chrono::seconds(10));

}  // namespace ca2::t265
