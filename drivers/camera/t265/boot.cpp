#include "drivers/camera/t265/boot.h"

#include <algorithm>
#include <thread>

#include "core/types/text.h"
#include "drivers/camera/t265/protocol.h"
#include "drivers/usb/usb_device.h"

namespace ca2::t265 {
namespace {

using std::chrono::milliseconds, std::chrono::seconds;
using Clock = std::chrono::steady_clock;

/// Bytes per transfer; a multiple of every packet size, so that only the last packet can be a short one.
constexpr std::size_t chunk = 1u << 18;

/// Waits for a device of that id that is not one of `before`.
Result<UsbDeviceInfo> wait_for(UsbId id, const std::vector<UsbDeviceInfo>& before, milliseconds patience) {
  const auto deadline = Clock::now() + patience;
  for (;;) {
    const auto found = list_usb_devices(std::span(&id, 1));
    if (!found) return fail(found.error());
    for (const UsbDeviceInfo& info : *found) {
      const auto same = [&](const UsbDeviceInfo& old) {
        return old.port == info.port && old.address == info.address;
      };
      if (std::none_of(before.begin(), before.end(), same)) return info;
    }
    if (Clock::now() >= deadline) {
      return fail(ErrorCode::unavailable, "T265",
                  formatted("did not come back as %04x:%04x within %g s", id.vendor, id.product,
                            std::chrono::duration<double>(patience).count()),
                  "unplug it and plug it in again; a hub needs power of its own");
    }
    std::this_thread::sleep_for(milliseconds(50));
  }
}

}  // namespace

Result<std::vector<UsbDeviceInfo>> list_devices() {
  const UsbId ids[] = {boot_id, camera_id};
  return list_usb_devices(ids);
}

Result<UsbDeviceInfo> boot(const UsbDeviceInfo& loader, const std::string& firmware, milliseconds patience) {
  const std::string where = "T265, USB " + loader.port;
  const auto before = list_usb_devices(std::span(&camera_id, 1));
  if (!before) return fail(before.error());
  {
    const auto device = UsbDevice::open(loader, interface, udev_patience);
    if (!device) return fail(device.error());
    const std::uint8_t endpoint = (*device)->first_bulk_out();
    if (endpoint == 0) return fail(ErrorCode::unavailable, where, "its boot loader has no bulk endpoint");
    const std::span bytes(reinterpret_cast<const std::uint8_t*>(firmware.data()), firmware.size());
    for (std::size_t at = 0; at < bytes.size(); at += chunk) {
      const auto part = bytes.subspan(at, std::min(chunk, bytes.size() - at));
      const UsbTransfer sent = (*device)->write(endpoint, part, seconds(5));
      if (sent.outcome == UsbOutcome::done && sent.size == part.size()) continue;
      // With the last bytes it may restart before it has acknowledged them.
      if (at + part.size() == bytes.size() && sent.outcome != UsbOutcome::stalled) break;
      return fail(ErrorCode::io, where,
                  formatted("took %zu of %zu bytes of firmware: %s", at + sent.size, bytes.size(),
                            text_of(sent.outcome)),
                  "unplug it and plug it in again");
    }
  }
  return wait_for(camera_id, *before, patience);
}

Result<void> reset(const UsbDeviceInfo& camera, milliseconds patience) {
  const auto before = list_usb_devices(std::span(&boot_id, 1));
  if (!before) return fail(before.error());
  {
    const auto device = UsbDevice::open(camera, interface, udev_patience);
    if (!device) return fail(device.error());
    // Whatever it answers: it is gone before it could say so.
    (*device)->vendor_request(reset_request, seconds(1));
  }
  if (const auto loader = wait_for(boot_id, *before, patience); !loader) return fail(loader.error());
  return {};
}

}  // namespace ca2::t265
