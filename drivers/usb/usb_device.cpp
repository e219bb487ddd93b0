#include "drivers/usb/usb_device.h"

#include <libusb-1.0/libusb.h>

#include "drivers/usb/usb_port.h"

namespace ca2 {
namespace {

/// Calls `visit` with every endpoint of the interface's first setting, until it answers true.
template <class Visit>
bool any_endpoint(libusb_device_handle* handle, int interface, Visit visit) {
  libusb_config_descriptor* config = nullptr;
  if (libusb_get_active_config_descriptor(libusb_get_device(handle), &config) < 0) return false;
  bool found = false;
  for (int i = 0; i < config->bNumInterfaces; ++i) {
    if (config->interface[i].num_altsetting < 1) continue;
    const libusb_interface_descriptor& setting = config->interface[i].altsetting[0];
    if (setting.bInterfaceNumber != interface) continue;
    for (int k = 0; k < setting.bNumEndpoints && !found; ++k) found = visit(setting.endpoint[k]);
  }
  libusb_free_config_descriptor(config);
  return found;
}

/// The device at that place and address, referenced; nullptr when it is not there any more.
libusb_device* find(libusb_context* context, const UsbDeviceInfo& info) {
  libusb_device** list = nullptr;
  const ssize_t count = libusb_get_device_list(context, &list);
  libusb_device* found = nullptr;
  for (ssize_t i = 0; i < count && !found; ++i) {
    if (libusb_get_device_address(list[i]) == info.address && usb_port(list[i]) == info.port) {
      found = libusb_ref_device(list[i]);
    }
  }
  if (count >= 0) libusb_free_device_list(list, 1);
  return found;
}

Error open_error(int code, const std::string& where) {
  const std::string what = std::string("cannot open the USB device: ") + libusb_strerror(code);
  if (code == LIBUSB_ERROR_ACCESS) {
    return {ErrorCode::no_permission, where, what,
            "install the udev rules of this package, or join the group they name, and plug it in again"};
  }
  if (code == LIBUSB_ERROR_BUSY) return {ErrorCode::unavailable, where, what, "another program is using it"};
  return {ErrorCode::unavailable, where, what};
}

}  // namespace

const char* text_of(UsbOutcome outcome) {
  switch (outcome) {
    case UsbOutcome::done:
      return "done";
    case UsbOutcome::timeout:
      return "no answer in time";
    case UsbOutcome::gone:
      return "unplugged";
    case UsbOutcome::stalled:
      return "refused by the device";
    case UsbOutcome::overflow:
      return "more data than announced";
    case UsbOutcome::failed:
      break;
  }
  return "USB transfer failed";
}

UsbOutcome usb_outcome(int code) {
  if (code >= 0) return UsbOutcome::done;
  switch (code) {
    case LIBUSB_ERROR_TIMEOUT:
      return UsbOutcome::timeout;
    case LIBUSB_ERROR_NO_DEVICE:
      return UsbOutcome::gone;
    case LIBUSB_ERROR_PIPE:
      return UsbOutcome::stalled;
    case LIBUSB_ERROR_OVERFLOW:
      return UsbOutcome::overflow;
    default:
      return UsbOutcome::failed;
  }
}

Result<std::unique_ptr<UsbDevice>> UsbDevice::open(const UsbDeviceInfo& info, int interface,
                                                   std::chrono::milliseconds patience) {
  const std::string where = "USB " + info.port;
  auto context = new_usb_context();
  if (!context) return fail(context.error());
  libusb_device* device = find(context->get(), info);
  if (!device) return fail(ErrorCode::unavailable, where, "the device is not there any more");
  libusb_device_handle* handle = nullptr;
  const auto deadline = std::chrono::steady_clock::now() + patience;
  int code = libusb_open(device, &handle);
  while (code == LIBUSB_ERROR_ACCESS && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    code = libusb_open(device, &handle);
  }
  libusb_unref_device(device);
  if (code < 0) return fail(open_error(code, where));
  // Not supported on every system, and then there is no kernel driver to take it from either.
  libusb_set_auto_detach_kernel_driver(handle, 1);
  code = libusb_claim_interface(handle, interface);
  if (code < 0) {
    libusb_close(handle);
    return fail(open_error(code, where));
  }
  return std::unique_ptr<UsbDevice>(new UsbDevice(info, std::move(*context), handle, interface));
}

UsbDevice::UsbDevice(UsbDeviceInfo info, std::shared_ptr<libusb_context> context,
                     libusb_device_handle* handle, int interface)
    : info_(std::move(info)), context_(std::move(context)), handle_(handle), interface_(interface) {
  events_ = std::thread([this] {
    while (!closing_) {
      timeval second{1, 0};
      libusb_handle_events_timeout(context_.get(), &second);
    }
  });
}

UsbDevice::~UsbDevice() {
  closing_ = true;
  libusb_interrupt_event_handler(context_.get());
  events_.join();
  libusb_release_interface(handle_, interface_);
  libusb_close(handle_);
}

UsbTransfer UsbDevice::write(std::uint8_t endpoint, std::span<const std::uint8_t> bytes,
                             std::chrono::milliseconds timeout) {
  int moved = 0;
  // libusb takes one kind of pointer for both directions and does not write through it for OUT endpoints.
  const int code =
      libusb_bulk_transfer(handle_, endpoint, const_cast<std::uint8_t*>(bytes.data()),
                           static_cast<int>(bytes.size()), &moved, static_cast<unsigned>(timeout.count()));
  return {usb_outcome(code), static_cast<std::size_t>(moved)};
}

UsbTransfer UsbDevice::read(std::uint8_t endpoint, std::span<std::uint8_t> bytes,
                            std::chrono::milliseconds timeout) {
  int moved = 0;
  const int code = libusb_bulk_transfer(handle_, endpoint, bytes.data(), static_cast<int>(bytes.size()),
                                        &moved, static_cast<unsigned>(timeout.count()));
  return {usb_outcome(code), static_cast<std::size_t>(moved)};
}

UsbTransfer UsbDevice::vendor_request(std::uint8_t request, std::chrono::milliseconds timeout) {
  constexpr std::uint8_t type =
      std::uint8_t{LIBUSB_REQUEST_TYPE_VENDOR} | std::uint8_t{LIBUSB_RECIPIENT_DEVICE};
  const int code = libusb_control_transfer(handle_, type, request, 0, 0, nullptr, 0,
                                           static_cast<unsigned>(timeout.count()));
  return {usb_outcome(code), 0};
}

std::uint8_t UsbDevice::first_bulk_out() const {
  std::uint8_t address = 0;
  any_endpoint(handle_, interface_, [&](const libusb_endpoint_descriptor& endpoint) {
    const bool bulk =
        (endpoint.bmAttributes & LIBUSB_TRANSFER_TYPE_MASK) == LIBUSB_ENDPOINT_TRANSFER_TYPE_BULK;
    if (!bulk || (endpoint.bEndpointAddress & LIBUSB_ENDPOINT_IN)) return false;
    address = endpoint.bEndpointAddress;
    return true;
  });
  return address;
}

bool UsbDevice::has_endpoint(std::uint8_t address) const {
  return any_endpoint(handle_, interface_, [&](const libusb_endpoint_descriptor& endpoint) {
    return endpoint.bEndpointAddress == address;
  });
}

}  // namespace ca2
