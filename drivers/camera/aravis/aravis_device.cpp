#include "drivers/camera/aravis/aravis_device.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include "drivers/camera/aravis/features.h"

namespace ca2 {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto controller_patience = std::chrono::seconds(5);
constexpr auto controller_retry = std::chrono::milliseconds(500);

/// The first of these that is not empty, joined by a space with the others.
std::string joined(std::initializer_list<std::string> words) {
  std::string text;
  for (const std::string& word : words) {
    if (!word.empty()) text += (text.empty() ? "" : " ") + word;
  }
  return text;
}

/// The name that arv_open_device knows for what a person wrote.
Result<std::string> resolve(const std::string& id) {
  arv_update_device_list();
  std::vector<std::string> ids;
  for (guint i = 0; i < arv_get_n_devices(); ++i) {
    const std::string full = text_or_empty(arv_get_device_id(i));
    ids.push_back(full);
    for (const char* other :
         {arv_get_device_serial_nbr(i), arv_get_device_address(i), arv_get_device_physical_id(i)}) {
      if (!id.empty() && text_or_empty(other) == id) return full;
    }
  }
  if (id.empty() && ids.size() == 1) return ids[0];
  if (std::find(ids.begin(), ids.end(), id) != ids.end()) return id;
  // Cameras behind a router do not hear the question; their address is enough.
  const GObjectPtr<GInetAddress> address(g_inet_address_new_from_string(id.c_str()));
  if (address) return id;
  std::string there;
  for (const std::string& full : ids) there += (there.empty() ? "" : ", ") + full;
  if (id.empty() && !ids.empty()) {
    return fail(ErrorCode::unavailable, "aravis", "there are several cameras",
                "say which with 'id': " + there);
  }
  return fail(
      ErrorCode::unavailable, "aravis", id.empty() ? "no camera answers" : "no camera '" + id + "' answers",
      there.empty() ? "is it powered, and on a network of this host? `ca2 sensors` lists those that answer"
                    : "there are " + there);
}

}  // namespace

std::vector<FoundCamera> find_aravis_cameras() {
  arv_update_device_list();
  std::vector<FoundCamera> found;
  for (guint i = 0; i < arv_get_n_devices(); ++i) {
    FoundCamera camera;
    camera.driver = "aravis";
    camera.id = text_or_empty(arv_get_device_id(i));
    camera.description =
        joined({text_or_empty(arv_get_device_vendor(i)), text_or_empty(arv_get_device_model(i)) + ",",
                text_or_empty(arv_get_device_protocol(i)), "at", text_or_empty(arv_get_device_address(i))});
    camera.source = {{"driver", "aravis"}, {"id", camera.id}};
    found.push_back(std::move(camera));
  }
  std::sort(found.begin(), found.end(),
            [](const FoundCamera& a, const FoundCamera& b) { return a.id < b.id; });
  return found;
}

Result<GObjectPtr<ArvDevice>> open_aravis_device(const std::string& id) {
  const Clock::time_point end = Clock::now() + controller_patience;
  const auto name = resolve(id);
  if (!name) return fail(name.error());
  for (;;) {
    GErrorHolder error;
    GObjectPtr<ArvDevice> device(arv_open_device(name->c_str(), error.out()));
    const bool taken =
        device && ARV_IS_GV_DEVICE(device.get()) && !arv_gv_device_is_controller(ARV_GV_DEVICE(device.get()));
    if (device && !taken) return device;
    if (!taken && !error.is(ARV_DEVICE_ERROR, ARV_DEVICE_ERROR_NOT_CONTROLLER)) {
      return fail(ErrorCode::unavailable, *name, "cannot be opened: " + error.text());
    }
    if (Clock::now() > end) {
      return fail(ErrorCode::unavailable, *name, "another program controls the camera", "stop it first");
    }
    device.reset();
    std::this_thread::sleep_for(controller_retry);
  }
}

std::string describe_aravis_device(ArvDevice* device) {
  const Features features(device);
  const auto word = [&](const char* name) { return name ? features.text(name).value_or("") : ""; };
  std::string text = joined({word("DeviceVendorName"), word("DeviceModelName")});
  for (const char* name : {"DeviceSerialNumber", "DeviceID"}) {
    const std::string serial = features.has(name) ? word(name) : "";
    if (serial.empty()) continue;
    text += ", serial " + serial;
    break;
  }
  const std::string firmware = word(features.name(Feature::firmware));
  return firmware.empty() ? text : text + ", firmware " + firmware;
}

}  // namespace ca2
