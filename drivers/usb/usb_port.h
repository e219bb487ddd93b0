/// @file A device's place, inside drivers/usb.
#pragma once

#include <string>

struct libusb_device;

namespace ca2 {

/// "2-1.3": bus 2, port 1, port 3 of the hub there; also the kernel's name of the device in /sys.
std::string usb_port(libusb_device* device);

}  // namespace ca2
