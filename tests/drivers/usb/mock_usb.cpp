#include "tests/drivers/usb/mock_usb.h"

#include <sys/ioctl.h>  // before usbdevice_fs.h, which needs _IO

#include <linux/usbdevice_fs.h>
#include <umockdev.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <mutex>
#include <stdexcept>

#include "core/types/text.h"

namespace ca2::test {
namespace {

std::string hex(std::span<const std::uint8_t> bytes) {
  std::string out;
  for (const std::uint8_t byte : bytes) out += formatted("%02X", byte);
  return out;
}

/// Device, configuration, interface and endpoint descriptors.
std::string descriptors(const MockUsbDevice& device) {
  const auto low = [](unsigned v) { return static_cast<std::uint8_t>(v); };
  const auto high = [](unsigned v) { return static_cast<std::uint8_t>(v >> 8); };
  Bytes out{18,
            1,
            0,
            2,
            0,
            0,
            0,
            64,
            low(device.vendor),
            high(device.vendor),
            low(device.product),
            high(device.product),
            0,
            1,
            0,
            0,
            0,
            1};
  const auto count = static_cast<unsigned>(device.endpoints.size());
  const unsigned total = 9 + 9 + 7 * count;
  for (const std::uint8_t byte : {std::uint8_t{9}, std::uint8_t{2}, low(total), high(total), std::uint8_t{1},
                                  std::uint8_t{1}, std::uint8_t{0}, std::uint8_t{0x80}, std::uint8_t{250}}) {
    out.push_back(byte);
  }
  for (const std::uint8_t byte :
       {std::uint8_t{9}, std::uint8_t{4}, std::uint8_t{0}, std::uint8_t{0}, low(count), std::uint8_t{0xff},
        std::uint8_t{0}, std::uint8_t{0}, std::uint8_t{0}}) {
    out.push_back(byte);
  }
  for (const std::uint8_t address : device.endpoints) {
    for (const std::uint8_t byte : {std::uint8_t{7}, std::uint8_t{5}, address, std::uint8_t{2},
                                    std::uint8_t{0}, std::uint8_t{2}, std::uint8_t{0}}) {
      out.push_back(byte);
    }
  }
  return hex(out);
}

/// One open file's transfers. The kernel's side of usbfs, as far as libusb uses it.
struct Transfers {
  MockUsbDevice device;
  std::mutex mutex;
  std::deque<UMockdevIoctlData*> pending, finished;

  static usbdevfs_urb& urb(UMockdevIoctlData* data) { return *reinterpret_cast<usbdevfs_urb*>(data->data); }

  static UMockdevIoctlData* buffer(UMockdevIoctlData* data) {
    return umockdev_ioctl_data_resolve(data, offsetof(usbdevfs_urb, buffer),
                                       static_cast<gsize>(std::max(1, urb(data).buffer_length)), nullptr);
  }

  /// 0 or an errno.
  int submit(UMockdevIoctlData* data) {
    usbdevfs_urb& request = urb(data);
    if (!(request.endpoint & 0x80)) {
      UMockdevIoctlData* bytes = buffer(data);
      const auto size = static_cast<std::size_t>(request.buffer_length);
      const int code = device.written(request.endpoint, {bytes->data, size});
      umockdev_ioctl_data_unref(bytes);
      if (code != 0) return code;
      request.actual_length = request.buffer_length;
      request.status = 0;
      finished.push_back(umockdev_ioctl_data_ref(data));
      return 0;
    }
    pending.push_back(umockdev_ioctl_data_ref(data));
    return 0;
  }

  /// Gives pending reads what has come meanwhile.
  void serve() {
    for (std::size_t i = 0; i < pending.size();) {
      usbdevfs_urb& request = urb(pending[i]);
      auto got = device.read(request.endpoint);
      if (!got) {
        ++i;
        continue;
      }
      UMockdevIoctlData* bytes = buffer(pending[i]);
      const auto size = std::min(got->size(), static_cast<std::size_t>(request.buffer_length));
      umockdev_ioctl_data_update(bytes, 0, got->data(), static_cast<gint>(size));
      umockdev_ioctl_data_unref(bytes);
      request.actual_length = static_cast<int>(size);
      request.status = size < got->size() ? -EOVERFLOW : 0;
      finish(i);
    }
  }

  void finish(std::size_t i) {
    finished.push_back(pending[i]);
    pending.erase(pending.begin() + static_cast<std::ptrdiff_t>(i));
  }

  bool discard(gulong address) {
    for (std::size_t i = 0; i < pending.size(); ++i) {
      if (pending[i]->client_addr != address) continue;
      urb(pending[i]).status = -ENOENT;
      urb(pending[i]).actual_length = 0;
      finish(i);
      return true;
    }
    return false;
  }
};

gboolean on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer user) {
  auto& transfers = *static_cast<Transfers*>(user);
  const std::lock_guard lock(transfers.mutex);
  UMockdevIoctlData* argument = umockdev_ioctl_client_get_arg(client);
  const auto answer = [&](int code) {
    umockdev_ioctl_client_complete(client, code == 0 ? 0 : -1, code);
    return TRUE;
  };
  switch (umockdev_ioctl_client_get_request(client)) {
    case USBDEVFS_GET_CAPABILITIES: {
      UMockdevIoctlData* data = umockdev_ioctl_data_resolve(argument, 0, 4, nullptr);
      std::uint8_t none[4] = {};
      umockdev_ioctl_data_update(data, 0, none, 4);
      umockdev_ioctl_data_unref(data);
      return answer(0);
    }
    case USBDEVFS_CLAIMINTERFACE:
      return answer(transfers.device.claim());
    case USBDEVFS_RELEASEINTERFACE:
      return answer(0);
    case USBDEVFS_GETDRIVER:
    case USBDEVFS_IOCTL:  // detach the kernel's driver
      return answer(ENODATA);
    case USBDEVFS_SUBMITURB: {
      UMockdevIoctlData* data = umockdev_ioctl_data_resolve(argument, 0, sizeof(usbdevfs_urb), nullptr);
      UMockdevIoctlData* bytes = Transfers::buffer(data);
      const int code = transfers.submit(data);
      umockdev_ioctl_data_unref(bytes);
      umockdev_ioctl_data_unref(data);
      return answer(code);
    }
    case USBDEVFS_DISCARDURB: {
      UMockdevIoctlData* data = umockdev_ioctl_data_resolve(argument, 0, sizeof(usbdevfs_urb), nullptr);
      const bool found = transfers.discard(data->client_addr);
      umockdev_ioctl_data_unref(data);
      return answer(found ? 0 : EINVAL);
    }
    case USBDEVFS_REAPURB:
    case USBDEVFS_REAPURBNDELAY: {
      transfers.serve();
      if (transfers.finished.empty()) return answer(EAGAIN);
      UMockdevIoctlData* slot = umockdev_ioctl_data_resolve(argument, 0, sizeof(void*), nullptr);
      umockdev_ioctl_data_set_ptr(slot, 0, transfers.finished.front());
      umockdev_ioctl_data_unref(slot);
      umockdev_ioctl_data_unref(transfers.finished.front());
      transfers.finished.pop_front();
      return answer(0);
    }
    default:
      return answer(ENOTTY);
  }
}

}  // namespace

struct MockUsb::State {
  UMockdevTestbed* testbed = umockdev_testbed_new();
  std::vector<std::unique_ptr<Transfers>> devices;
  std::vector<UMockdevIoctlBase*> handlers;
  std::vector<std::string> nodes;
};

bool MockUsb::possible() {
  // umockdev's own answer is only right while a testbed lives.
  const char* preloaded = std::getenv("LD_PRELOAD");
  return preloaded && std::strstr(preloaded, "umockdev");
}

MockUsb::MockUsb() : state_(std::make_unique<State>()) {}

MockUsb::~MockUsb() {
  for (const std::string& node : state_->nodes) {
    umockdev_testbed_detach_ioctl(state_->testbed, node.c_str(), nullptr);
  }
  for (UMockdevIoctlBase* handler : state_->handlers) g_object_unref(handler);
  g_object_unref(state_->testbed);
}

void MockUsb::plug_in(const MockUsbDevice& device) {
  const std::string node = formatted("bus/usb/001/%03d", device.address);
  std::string text = "P: /devices/usb1/" + device.place + "\nN: " + node +
                     "\nE: DEVTYPE=usb_device\nE: SUBSYSTEM=usb\nE: BUSNUM=001\n" +
                     formatted("E: DEVNUM=%03d\n", device.address) + "E: DEVNAME=/dev/" + node + "\n" +
                     formatted("E: PRODUCT=%x/%x/0\n", device.vendor, device.product) +
                     "A: bConfigurationValue=1\\n\nA: busnum=1\\n\n" +
                     formatted("A: devnum=%d\\n\n", device.address) + "A: speed=" + device.speed + "\\n\n" +
                     formatted("A: idVendor=%04x\\n\nA: idProduct=%04x\\n\n", device.vendor, device.product);
  if (!device.serial.empty()) text += "A: serial=" + device.serial + "\\n\n";
  text += "H: descriptors=" + descriptors(device) + "\n";
  GError* error = nullptr;
  if (!umockdev_testbed_add_from_string(state_->testbed, text.c_str(), &error)) {
    throw std::runtime_error(error->message);
  }
  auto transfers = std::make_unique<Transfers>();
  transfers->device = device;
  UMockdevIoctlBase* handler = umockdev_ioctl_base_new();
  g_signal_connect(handler, "handle-ioctl", reinterpret_cast<GCallback>(on_ioctl), transfers.get());
  const std::string path = "/dev/" + node;
  if (!umockdev_testbed_attach_ioctl(state_->testbed, path.c_str(), handler, &error)) {
    throw std::runtime_error(error->message);
  }
  state_->devices.push_back(std::move(transfers));
  state_->handlers.push_back(handler);
  state_->nodes.push_back(path);
}

}  // namespace ca2::test
