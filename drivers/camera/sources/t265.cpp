/// @file Intel RealSense T265 over libusb: two fisheyes with their factory calibration (docs/t265.md).
#include <strings.h>

#include <algorithm>

#include "core/types/text.h"
#include "drivers/camera/camera_driver.h"
#include "drivers/camera/t265/boot.h"
#include "drivers/camera/t265/firmware.h"
#include "drivers/camera/t265/t265_camera.h"

namespace ca2 {
namespace {

using namespace t265;

constexpr CameraOption options_known[] = {
    {"id", "serial number, the 12 hexadecimal digits on its label; the only T265 by default", true},
    {"firmware", "path of target-0.2.0.951.mvcmd, which a T265 needs after power-up"},
    {"firmware_sha1", "of the firmware file, when it is another one"},
    {"exposure_us", "us, 200 to 16000, for both imagers; automatic by default"},
    {"gain_db", "dB, 0 to 20, with exposure_us; 0 by default"},
    {"silence", "s without a picture after which it counts as hung, 0.1 to 60, 1 by default"}};

struct Wanted {
  std::string id;  ///< as in options_known; empty: any
  std::string firmware, sha1;
};

/// As on the label: USB has four more digits, which are zero.
std::string serial_of(const UsbDeviceInfo& camera) {
  return camera.serial.substr(0, 12);
}

bool is_wanted(const UsbDeviceInfo& camera, const Wanted& wanted) {
  return wanted.id.empty() || ::strcasecmp(serial_of(camera).c_str(), wanted.id.c_str()) == 0;
}

/// Loads the firmware only when it is needed: a camera that is up works without the file.
Result<UsbDeviceInfo> bring_up(const UsbDeviceInfo& loader, const Wanted& wanted) {
  if (wanted.firmware.empty()) {
    return fail(ErrorCode::config, "T265, USB " + loader.port, "waits for its firmware, and no file is given",
                firmware_hint());
  }
  const auto firmware = read_firmware(wanted.firmware, wanted.sha1);
  if (!firmware) return fail(firmware.error());
  return boot(loader, *firmware);
}

/// The camera that is wanted, booted. A boot loader does not know its serial number: where one is asked for,
/// each has to be booted to see whether it is the one.
Result<UsbDeviceInfo> find_camera(const Wanted& wanted) {
  const auto devices = list_devices();
  if (!devices) return fail(devices.error());
  std::vector<UsbDeviceInfo> cameras, loaders;
  for (const UsbDeviceInfo& device : *devices) {
    if (device.id == boot_id) {
      loaders.push_back(device);
    } else if (is_wanted(device, wanted)) {
      cameras.push_back(device);
    }
  }
  if (wanted.id.empty() && cameras.size() + loaders.size() > 1) {
    return fail(ErrorCode::config, "T265", formatted("%zu are connected", cameras.size() + loaders.size()),
                "say which by 'id'; `ca2 sensors` lists them");
  }
  if (!cameras.empty()) return cameras.front();
  for (const UsbDeviceInfo& loader : loaders) {
    auto camera = bring_up(loader, wanted);
    if (!camera) return camera;
    if (is_wanted(*camera, wanted)) return camera;
  }
  return fail(ErrorCode::unavailable, "T265",
              wanted.id.empty() ? "none is connected" : "'" + wanted.id + "' is not connected",
              "check the cable and `ca2 sensors`");
}

/// Opens the camera, and once more after a restart when it is there but does not answer: what a program that
/// was killed leaves behind.
Result<std::unique_ptr<Device>> open_device(const Wanted& wanted) {
  const auto camera = find_camera(wanted);
  if (!camera) return fail(camera.error());
  auto device = Device::open(*camera);
  if (device || device.error().code != ErrorCode::io) return device;
  if (const auto restarted = reset(*camera); !restarted) return fail(restarted.error());
  const auto again = find_camera(wanted);
  if (!again) return fail(again.error());
  return Device::open(*again);
}

Result<std::unique_ptr<CameraSource>> open(OptionReader& reader) {
  Wanted wanted;
  wanted.id = reader.text("id").value_or("");
  wanted.firmware = reader.text("firmware").value_or("");
  wanted.sha1 = reader.text("firmware_sha1").value_or(std::string(firmware_sha1));
  CameraOptions options;
  const auto exposure = reader.number("exposure_us", least_exposure, most_exposure);
  const auto gain = reader.number("gain_db", 0, most_gain);
  const double silence = reader.number("silence", 0.1, 60).value_or(1);
  if (gain && !exposure) reader.problem("'gain_db' needs 'exposure_us'", "automatic exposure sets both");
  if (const auto good = reader.done(); !good) return fail(good.error());
  options.exposure = {!exposure, exposure.value_or(options.exposure.time), gain.value_or(0)};
  options.silence = std::chrono::milliseconds(static_cast<int>(1000 * silence));

  auto device = open_device(wanted);
  if (!device) return fail(device.error());
  auto camera = T265Camera::create(std::move(*device), options);
  if (!camera) return fail(camera.error());
  return std::move(*camera);
}

Result<std::vector<FoundCamera>> list() {
  const auto devices = list_devices();
  if (!devices) return fail(devices.error());
  std::vector<FoundCamera> out;
  for (const UsbDeviceInfo& device : *devices) {
    FoundCamera found;
    found.driver = "t265";
    const bool up = device.id == camera_id;
    found.id = up ? serial_of(device) : device.port;
    found.description = "Intel RealSense T265, USB " + device.port + (up ? "" : ", without firmware yet");
    found.source = {{"driver", "t265"}};
    // A boot loader does not know its serial number.
    if (up) found.source["id"] = found.id;
    if (!up) found.source["firmware"] = "target-0.2.0.951.mvcmd";
    // A boot loader is slow whatever it is plugged into.
    if (up && device.megabits > 0 && device.megabits < 5000) {
      found.problem = "on USB 2, which is too slow for every picture: use a USB 3 port";
    }
    out.push_back(std::move(found));
  }
  return out;
}

}  // namespace

const CameraDriver& t265_camera_driver() {
  static const CameraDriver driver{
      "t265", "Intel RealSense T265: two fisheyes with their factory calibration", options_known, open, list};
  return driver;
}

}  // namespace ca2
