#include "drivers/camera/camera_driver.h"

#include <array>

namespace ca2 {

#define CA2_CAMERA_SOURCE_LEFT_OUT(name, option)
#define CA2_CAMERA_SOURCE(name) const CameraDriver& name##_camera_driver();
#include "drivers/camera/sources.def"
#undef CA2_CAMERA_SOURCE
#undef CA2_CAMERA_SOURCE_LEFT_OUT

namespace {

/// A driver that this build has not, and the CMake option that brings it.
struct LeftOut {
  std::string_view name, option;
};

std::string how_to_have(const LeftOut& driver) {
  return "this build was made without it: configure it with -D" + std::string(driver.option) + "=ON";
}

const std::vector<LeftOut>& left_out_drivers() {
#define CA2_CAMERA_SOURCE(name)
#define CA2_CAMERA_SOURCE_LEFT_OUT(name, option) {#name, #option},
  static const std::vector<LeftOut> drivers{
#include "drivers/camera/sources.def"
  };
#undef CA2_CAMERA_SOURCE
#undef CA2_CAMERA_SOURCE_LEFT_OUT
  return drivers;
}

Result<const CameraDriver*> driver_of(const SourceOptions& source) {
  std::vector<std::string_view> names;
  for (const CameraDriver* driver : camera_drivers()) names.push_back(driver->name);
  const auto asked = source.find("driver");
  if (asked == source.end()) {
    return fail(ErrorCode::config, "source", "has no 'driver'", suggest("", names));
  }
  for (const CameraDriver* driver : camera_drivers()) {
    if (driver->name == asked->second) return driver;
  }
  std::string hint = suggest(asked->second, names);
  for (const LeftOut& driver : left_out_drivers()) {
    if (driver.name == asked->second) hint = how_to_have(driver);
  }
  return fail(ErrorCode::config, "source", "there is no camera driver '" + asked->second + "'",
              std::move(hint));
}

/// What tells this device from others.
SourceOptions identity(const CameraDriver& driver, const SourceOptions& source) {
  SourceOptions out{{"driver", std::string(driver.name)}};
  for (const CameraOption& option : driver.options) {
    const auto value = source.find(std::string(option.name));
    if (option.identifies && value != source.end()) out.insert(*value);
  }
  return out;
}

}  // namespace

std::span<const CameraDriver* const> camera_drivers() {
#define CA2_CAMERA_SOURCE_LEFT_OUT(name, option)
  static const std::array drivers{
#define CA2_CAMERA_SOURCE(name) &name##_camera_driver(),
#include "drivers/camera/sources.def"
#undef CA2_CAMERA_SOURCE
#undef CA2_CAMERA_SOURCE_LEFT_OUT
  };
  return drivers;
}

Result<std::unique_ptr<CameraSource>> open_camera(const SourceOptions& source) {
  const auto driver = driver_of(source);
  if (!driver) return fail(driver.error());
  std::vector<std::string_view> known{"driver"};
  for (const CameraOption& option : (*driver)->options) known.push_back(option.name);
  OptionReader options(source, known);
  return (*driver)->open(options);
}

CameraListing list_cameras() {
  CameraListing listing;
  for (const CameraDriver* driver : camera_drivers()) {
    auto found = driver->list();
    if (!found) {
      listing.problems.insert(listing.problems.end(), found.error().problems.begin(),
                              found.error().problems.end());
      continue;
    }
    for (FoundCamera& camera : *found) listing.cameras.push_back(std::move(camera));
  }
  for (const LeftOut& driver : left_out_drivers()) {
    listing.problems.push_back(
        {std::string(driver.name), "its cameras were not looked for", how_to_have(driver)});
  }
  return listing;
}

Result<std::vector<CameraDevice>> camera_devices(const std::map<std::string, RigCamera>& cameras) {
  std::vector<CameraDevice> devices;
  std::vector<SourceOptions> identities;  // of the devices
  std::vector<Problem> problems;
  for (const auto& [name, camera] : cameras) {
    const std::string where = "camera " + name;
    const auto driver = driver_of(camera.source);
    if (!driver) {
      for (const Problem& problem : driver.error().problems) {
        problems.push_back({where + ": " + problem.where, problem.what, problem.hint});
      }
      continue;
    }
    SourceOptions source = camera.source;
    const auto imager_node = source.extract("imager");
    const std::string imager = imager_node.empty() ? "" : imager_node.mapped();
    const SourceOptions key = identity(**driver, source);
    std::size_t i = 0;
    while (i < identities.size() && identities[i] != key) ++i;
    if (i == identities.size()) {
      identities.push_back(key);
      devices.push_back({source, {}});
    }
    CameraDevice& device = devices[i];
    for (const auto& [option, value] : source) {
      const auto [there, added] = device.source.emplace(option, value);
      if (!added && there->second != value) {
        problems.push_back({where,
                            "'" + option + "' is '" + value + "', and '" + there->second +
                                "' for another camera of the same device",
                            "give it once"});
      }
    }
    const auto [other, added] = device.cameras.emplace(imager, name);
    if (!added) {
      problems.push_back({where,
                          imager.empty()
                              ? "camera " + other->second + " has the same source"
                              : "camera " + other->second + " has the same imager '" + imager + "'",
                          "name another device, or another 'imager' of it"});
    }
  }
  if (!problems.empty()) return fail(ErrorCode::config, std::move(problems));
  return devices;
}

Result<int> find_stream(const CameraSource& source, std::string_view imager) {
  std::vector<std::string_view> names;
  for (const CameraStream& stream : source.streams()) {
    if (stream.name == imager) return static_cast<int>(names.size());
    names.push_back(stream.name);
  }
  if (names.size() == 1 && names[0].empty()) {
    return fail(ErrorCode::config, "source",
                source.description() + " has no imager '" + std::string(imager) + "'",
                "it has a single one: leave 'imager' out");
  }
  return fail(ErrorCode::config, "source",
              imager.empty() ? source.description() + " has several imagers: say which with 'imager'"
                             : source.description() + " has no imager '" + std::string(imager) + "'",
              suggest(imager, names));
}

}  // namespace ca2
