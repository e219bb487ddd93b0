#include "tests/devices/t265/raw_gadget.h"

#include <fcntl.h>
#include <linux/usb/raw_gadget.h>
#include <sys/ioctl.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <system_error>

namespace ca2::test {
namespace {

int checked(int result, const char* what) {
  if (result < 0) throw std::system_error(errno, std::generic_category(), what);
  return result;
}

/// A usb_raw_ep_io with its data behind it.
Bytes io(int endpoint, std::size_t size, std::span<const std::uint8_t> data = {}) {
  usb_raw_ep_io header{};
  header.ep = static_cast<std::uint16_t>(endpoint);
  header.length = static_cast<std::uint32_t>(size);
  Bytes out(sizeof header + size);
  std::memcpy(out.data(), &header, sizeof header);
  if (!data.empty()) std::memcpy(out.data() + sizeof header, data.data(), data.size());
  return out;
}

template <class T>
void append(Bytes& out, const T& value, std::size_t size) {
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(&value);
  out.insert(out.end(), bytes, bytes + size);
}

}  // namespace

RawGadget::RawGadget(GadgetDescription description) : description_(std::move(description)) {
  fd_ = checked(::open("/dev/raw-gadget", O_RDWR | O_CLOEXEC), "/dev/raw-gadget");
  usb_raw_init init{};
  std::strcpy(reinterpret_cast<char*>(init.driver_name), "dummy_udc");
  std::strcpy(reinterpret_cast<char*>(init.device_name), "dummy_udc.0");
  init.speed = description_.super_speed ? USB_SPEED_SUPER : USB_SPEED_HIGH;
  checked(::ioctl(fd_, USB_RAW_IOCTL_INIT, &init), "INIT");
  checked(::ioctl(fd_, USB_RAW_IOCTL_RUN, 0), "RUN");
}

usb_endpoint_descriptor RawGadget::endpoint_descriptor(const GadgetEndpoint& endpoint) const {
  usb_endpoint_descriptor out{};
  out.bLength = USB_DT_ENDPOINT_SIZE;
  out.bDescriptorType = USB_DT_ENDPOINT;
  out.bEndpointAddress = endpoint.address;
  out.bmAttributes = endpoint.interrupt ? USB_ENDPOINT_XFER_INT : USB_ENDPOINT_XFER_BULK;
  out.wMaxPacketSize = description_.super_speed || endpoint.interrupt ? 1024 : 512;
  out.bInterval = endpoint.interrupt ? 4 : 0;
  return out;
}

void RawGadget::enable_endpoints() {
  if (!handles_.empty()) return;  // configured once more
  for (const GadgetEndpoint& endpoint : description_.endpoints) {
    usb_endpoint_descriptor descriptor = endpoint_descriptor(endpoint);
    handles_.push_back(checked(::ioctl(fd_, USB_RAW_IOCTL_EP_ENABLE, &descriptor), "EP_ENABLE"));
  }
  checked(::ioctl(fd_, USB_RAW_IOCTL_VBUS_DRAW, 250), "VBUS_DRAW");
  checked(::ioctl(fd_, USB_RAW_IOCTL_CONFIGURE, 0), "CONFIGURE");
}

Bytes RawGadget::device_descriptor() const {
  usb_device_descriptor out{};
  out.bLength = USB_DT_DEVICE_SIZE;
  out.bDescriptorType = USB_DT_DEVICE;
  out.bcdUSB = description_.super_speed ? 0x0300 : 0x0200;
  out.bMaxPacketSize0 = description_.super_speed ? 9 : 64;  // USB 3: as a power of two
  out.idVendor = description_.vendor;
  out.idProduct = description_.product;
  out.iManufacturer = 1;
  out.iProduct = 2;
  out.iSerialNumber = description_.serial.empty() ? 0 : 3;
  out.bNumConfigurations = 1;
  Bytes bytes;
  append(bytes, out, USB_DT_DEVICE_SIZE);
  return bytes;
}

Bytes RawGadget::configuration_descriptor() const {
  Bytes rest;
  usb_interface_descriptor interface {};
  interface.bLength = USB_DT_INTERFACE_SIZE;
  interface.bDescriptorType = USB_DT_INTERFACE;
  interface.bNumEndpoints = static_cast<std::uint8_t>(description_.endpoints.size());
  interface.bInterfaceClass = USB_CLASS_VENDOR_SPEC;
  append(rest, interface, USB_DT_INTERFACE_SIZE);
  for (const GadgetEndpoint& endpoint : description_.endpoints) {
    append(rest, endpoint_descriptor(endpoint), USB_DT_ENDPOINT_SIZE);
    if (!description_.super_speed) continue;
    usb_ss_ep_comp_descriptor companion{};
    companion.bLength = USB_DT_SS_EP_COMP_SIZE;
    companion.bDescriptorType = USB_DT_SS_ENDPOINT_COMP;
    companion.wBytesPerInterval = endpoint.interrupt ? 1024 : 0;
    append(rest, companion, USB_DT_SS_EP_COMP_SIZE);
  }
  usb_config_descriptor config{};
  config.bLength = USB_DT_CONFIG_SIZE;
  config.bDescriptorType = USB_DT_CONFIG;
  config.wTotalLength = static_cast<std::uint16_t>(USB_DT_CONFIG_SIZE + rest.size());
  config.bNumInterfaces = 1;
  config.bConfigurationValue = 1;
  config.bmAttributes = USB_CONFIG_ATT_ONE;
  config.bMaxPower = description_.super_speed ? 60 : 250;  // 480 and 500 mA
  Bytes out;
  append(out, config, USB_DT_CONFIG_SIZE);
  out.insert(out.end(), rest.begin(), rest.end());
  return out;
}

Bytes RawGadget::string_descriptor(int index) const {
  if (index == 0) return {4, USB_DT_STRING, 0x09, 0x04};  // English
  const std::string texts[] = {"Fake", "Fake T265", description_.serial};
  if (index > 3) return {};
  Bytes out{0, USB_DT_STRING};
  for (const char c : texts[index - 1]) {
    out.push_back(static_cast<std::uint8_t>(c));
    out.push_back(0);
  }
  out[0] = static_cast<std::uint8_t>(out.size());
  return out;
}

bool RawGadget::standard(const usb_ctrlrequest& request, Bytes& answer) {
  switch (request.bRequest) {
    case USB_REQ_GET_DESCRIPTOR:
      switch (request.wValue >> 8) {
        case USB_DT_DEVICE:
          answer = device_descriptor();
          return true;
        case USB_DT_CONFIG:
          answer = configuration_descriptor();
          return true;
        case USB_DT_STRING:
          answer = string_descriptor(request.wValue & 0xff);
          return !answer.empty();
        case USB_DT_BOS:
          answer = {5, USB_DT_BOS, 5, 0, 0};  // without capabilities
          return description_.super_speed;
        default:
          return false;
      }
    case USB_REQ_SET_CONFIGURATION:
      enable_endpoints();
      return true;
    case USB_REQ_SET_INTERFACE:
    case USB_REQ_SET_SEL:
    case USB_REQ_SET_ISOCH_DELAY:
      return true;
    case USB_REQ_GET_STATUS:
      answer = {0, 0};
      return true;
    default:
      return false;
  }
}

void RawGadget::serve(std::function<void()> configured, std::function<void(std::uint8_t)> vendor) {
  for (;;) {
    usb_ctrlrequest request{};
    alignas(usb_raw_event) std::uint8_t event[sizeof(usb_raw_event) + sizeof request];
    usb_raw_event header{};
    header.length = sizeof request;
    std::memcpy(event, &header, sizeof header);
    if (::ioctl(fd_, USB_RAW_IOCTL_EVENT_FETCH, event) < 0) {
      if (errno == EINTR) continue;
      checked(-1, "EVENT_FETCH");
    }
    std::memcpy(&header, event, sizeof header);
    if (header.type != USB_RAW_EVENT_CONTROL) continue;
    std::memcpy(&request, event + sizeof header, sizeof request);
    const int type = request.bRequestType & USB_TYPE_MASK;
    const bool to_host = request.bRequestType & USB_DIR_IN;
    Bytes answer;
    const bool known = type == USB_TYPE_STANDARD
                           ? standard(request, answer)
                           : type == USB_TYPE_VENDOR && !to_host && request.wLength == 0;
    if (!known) {
      ::ioctl(fd_, USB_RAW_IOCTL_EP0_STALL, 0);
      continue;
    }
    answer.resize(std::min<std::size_t>(answer.size(), request.wLength));
    Bytes packet = io(0, to_host ? answer.size() : request.wLength, answer);
    // Fails where the host has given up meanwhile; it will ask again.
    ::ioctl(fd_, to_host ? USB_RAW_IOCTL_EP0_WRITE : USB_RAW_IOCTL_EP0_READ, packet.data());
    if (type == USB_TYPE_VENDOR) vendor(request.bRequest);
    if (type == USB_TYPE_STANDARD && request.bRequest == USB_REQ_SET_CONFIGURATION) configured();
  }
}

int RawGadget::handle_of(std::uint8_t address) const {
  for (std::size_t i = 0; i < handles_.size(); ++i) {
    if (description_.endpoints[i].address == address) return handles_[i];
  }
  throw std::logic_error("no such endpoint");
}

Bytes RawGadget::read(std::uint8_t endpoint, std::size_t limit) {
  Bytes packet = io(handle_of(endpoint), limit);
  const int size = checked(::ioctl(fd_, USB_RAW_IOCTL_EP_READ, packet.data()), "EP_READ");
  const auto begin = packet.begin() + sizeof(usb_raw_ep_io);
  return {begin, begin + size};
}

void RawGadget::write(std::uint8_t endpoint, std::span<const std::uint8_t> bytes) {
  Bytes packet = io(handle_of(endpoint), bytes.size(), bytes);
  checked(::ioctl(fd_, USB_RAW_IOCTL_EP_WRITE, packet.data()), "EP_WRITE");
}

}  // namespace ca2::test
