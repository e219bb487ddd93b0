#include "drivers/usb/usb_devices.h"

#include <libusb-1.0/libusb.h>

#include <algorithm>
#include <fstream>

#include "drivers/usb/usb_port.h"

namespace ca2 {
namespace {

int megabits(libusb_device* device) {
  switch (libusb_get_device_speed(device)) {
    case LIBUSB_SPEED_FULL:
      return 12;
    case LIBUSB_SPEED_HIGH:
      return 480;
    case LIBUSB_SPEED_SUPER:
      return 5000;
    case LIBUSB_SPEED_SUPER_PLUS:
      return 10000;
    default:
      return 0;
  }
}

/// From the kernel, which read it when the device came: asking a hung device would hang us too.
std::string serial_number(const std::string& port) {
  std::ifstream file("/sys/bus/usb/devices/" + port + "/serial");
  std::string serial;
  std::getline(file, serial);
  return serial;
}

}  // namespace

std::string usb_port(libusb_device* device) {
  std::uint8_t ports[8];
  const int count = libusb_get_port_numbers(device, ports, sizeof ports);
  std::string text = std::to_string(libusb_get_bus_number(device));
  for (int i = 0; i < count; ++i) text += (i == 0 ? "-" : ".") + std::to_string(ports[i]);
  return text;
}

Result<std::shared_ptr<libusb_context>> new_usb_context() {
  libusb_context* context = nullptr;
  if (const int code = libusb_init(&context); code < 0) {
    return fail(ErrorCode::unavailable, "USB", std::string("libusb cannot start: ") + libusb_strerror(code),
                "is /dev/bus/usb there?");
  }
  return std::shared_ptr<libusb_context>(context, libusb_exit);
}

Result<std::vector<UsbDeviceInfo>> list_usb_devices(std::span<const UsbId> ids) {
  const auto context = new_usb_context();
  if (!context) return fail(context.error());
  libusb_device** list = nullptr;
  const ssize_t count = libusb_get_device_list(context->get(), &list);
  if (count < 0) {
    return fail(ErrorCode::io, "USB",
                std::string("cannot list devices: ") + libusb_strerror(static_cast<int>(count)));
  }
  std::vector<UsbDeviceInfo> out;
  for (ssize_t i = 0; i < count; ++i) {
    libusb_device_descriptor descriptor;
    if (libusb_get_device_descriptor(list[i], &descriptor) < 0) continue;
    UsbDeviceInfo info;
    info.id = {descriptor.idVendor, descriptor.idProduct};
    if (std::find(ids.begin(), ids.end(), info.id) == ids.end()) continue;
    info.port = usb_port(list[i]);
    info.address = libusb_get_device_address(list[i]);
    info.megabits = megabits(list[i]);
    info.serial = serial_number(info.port);
    out.push_back(std::move(info));
  }
  libusb_free_device_list(list, 1);
  std::sort(out.begin(), out.end(),
            [](const UsbDeviceInfo& a, const UsbDeviceInfo& b) { return a.port < b.port; });
  return out;
}

}  // namespace ca2
