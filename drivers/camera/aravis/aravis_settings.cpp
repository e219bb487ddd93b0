#include "drivers/camera/aravis/aravis_settings.h"

#include <algorithm>

#include "core/types/text.h"
#include "drivers/camera/aravis/camera_controls.h"
#include "drivers/camera/aravis/glib.h"

namespace ca2 {
namespace {

constexpr int most_pixels = 30000;  // px of a side

constexpr CameraOption options_known[] = {
    {"id",
     "vendor-model-serial, serial number, IP or MAC address, as `ca2 sensors` lists; default: the only one",
     true},
    {"format", "PFNC name: Mono8, Mono12p, BayerRG8, ...; default: 8 bits"},
    {"picture", "grey (default) or colour"},
    {"width", "px, of the region; default: the camera's"},
    {"height", "px"},
    {"offset_x", "px, of the region's left; even for Bayer"},
    {"offset_y", "px, of the region's top; even for Bayer"},
    {"binning", "pixels joined to one, both ways"},
    {"exposure_us", "microseconds, or auto; default: the camera's"},
    {"gain_db", "dB, or auto; default: the camera's"},
    {"frame_rate", "Hz; default: the camera's"},
    {"trigger", "off (default), software, or camera: as the camera is set, for triggers by wire"},
    {"packet_size", "bytes of a GigE packet, or auto (default): the largest that arrives"},
    {"silence", "s without a picture after which the camera counts as gone, three frame periods by default"},
    {"buffers", "pictures kept for the driver where the daemon is late, at most; 16 by default"},
    {"resend", "ask for lost packets again, true by default"},
    {"ptp", "true: the camera's clock follows the network's PTP master"},
    {"user_set", "settings stored in the camera, loaded first: Default, UserSet1, ..."},
    {"features", "further GenICam features: \"GammaEnable=false ReverseX=true\""}};

Result<void> set_region(const AravisSettings& settings, const Features& features) {
  if (settings.binning) {
    features.set_first_choice("BinningSelector", {"All", "Sensor"});
    for (const char* name : {"BinningHorizontal", "BinningVertical"}) {
      if (auto set = features.set_number(name, *settings.binning); !set) return set;
    }
  }
  if (!settings.width && !settings.height && !settings.offset_x && !settings.offset_y) return {};
  // Offsets bound the size and the size bounds the offsets: they go to zero first.
  for (const char* name : {"OffsetX", "OffsetY"}) {
    if (!features.has(name)) continue;
    if (auto set = features.set_number(name, 0); !set) return set;
  }
  const std::pair<const char*, std::optional<int>> sizes[] = {{"Width", settings.width},
                                                              {"Height", settings.height},
                                                              {"OffsetX", settings.offset_x},
                                                              {"OffsetY", settings.offset_y}};
  for (const auto& [name, value] : sizes) {
    if (!value) continue;
    if (const auto limits = features.limits(name);
        limits && (*value < limits->least || *value > limits->most)) {
      return fail(ErrorCode::config, name,
                  formatted("cannot be %d: from %g to %g", *value, limits->least, limits->most));
    }
    if (auto set = features.set_number(name, *value); !set) return set;
  }
  return {};
}

/// 8 bits, mono before Bayer before colours; what the camera has first of what is known here otherwise.
Result<void> set_format(const AravisSettings& settings, const Features& features) {
  std::string known;
  std::string best;
  int best_rank = 100;
  for (const std::string& name : features.choices("PixelFormat")) {
    const PixelFormat* format = find_pixel_format(name);
    if (!format) continue;
    known += (known.empty() ? "" : ", ") + name;
    const int rank = (format->bits == 8 ? 0 : 10) + (format->colour == PixelColour::mono ? 0
                                                     : format->bayer()                   ? 1
                                                                                         : 2);
    if (rank < best_rank) {
      best_rank = rank;
      best = name;
    }
  }
  const std::string& wanted = settings.format.empty() ? best : settings.format;
  if (wanted.empty()) return {};  // the camera calls its formats otherwise; their codes decide
  if (auto set = features.set_text("PixelFormat", wanted); !set) {
    return fail(ErrorCode::config, "PixelFormat", "the camera has no format '" + wanted + "'",
                "it has " + known);
  }
  return {};
}

Result<void> set_controls(const AravisSettings& settings, const Features& features) {
  // Exposure and gain before the rate that they bound. A camera that waits for triggers nobody sends would be
  // silent, so that they are switched off before the rate is set.
  std::vector<std::pair<std::string, std::string>> writes;
  for (const char* name : {"exposure_us", "gain_db", "trigger", "frame_rate"}) {
    const auto wanted = settings.controls.find(name);
    if (wanted != settings.controls.end()) writes.push_back(*wanted);
  }
  if (!settings.controls.count("trigger")) writes.insert(writes.begin(), {"trigger", "off"});
  for (const auto& [name, value] : writes) {
    if (name == "trigger" && value == "camera") continue;
    if (name != "trigger" || value != "off") {
      if (auto good = check_control(read_controls(features), name, value); !good) {
        return fail(ErrorCode::config, good.error().problems);
      }
    }
    if (auto set = write_control(features, name, value); !set) return set;
  }
  return {};
}

Result<void> enable_ptp(const Features& features) {
  bool asked = false;
  if (const char* mode = features.name(Feature::ptp_mode)) {
    asked = features.set_first_choice(mode, {"Slave", "SlaveOnly", "Auto"});
  }
  if (const char* enable = features.name(Feature::ptp_enable)) {
    if (auto set = features.set_boolean(enable, true); !set) return set;
    asked = true;
  }
  if (!asked) return fail(ErrorCode::config, "ptp", "the camera has no PTP", "leave 'ptp' out");
  return {};
}

}  // namespace

std::span<const CameraOption> aravis_options() {
  return options_known;
}

Result<AravisSettings> read_aravis_settings(OptionReader& options) {
  AravisSettings settings;
  settings.id = options.text("id").value_or("");
  settings.user_set = options.text("user_set").value_or("");
  settings.format = options.text("format").value_or("");
  settings.features = options.text("features").value_or("");
  constexpr std::string_view kinds[] = {"grey", "colour"};
  if (options.choice("picture", kinds) == "colour") settings.kind = PictureKind::colour;
  settings.width = options.integer("width", 1, most_pixels);
  settings.height = options.integer("height", 1, most_pixels);
  settings.offset_x = options.integer("offset_x", 0, most_pixels);
  settings.offset_y = options.integer("offset_y", 0, most_pixels);
  settings.binning = options.integer("binning", 1, 16);
  for (const char* name : {"exposure_us", "gain_db"}) {
    const auto value = options.text(name);
    if (value != "auto") options.number(name, -1e9, 1e9);
    if (value) settings.controls.emplace(name, *value);
  }
  if (options.number("frame_rate", 1e-3, 1e5))
    settings.controls.emplace("frame_rate", *options.text("frame_rate"));
  constexpr std::string_view triggers[] = {"off", "software", "camera"};
  if (const auto trigger = options.choice("trigger", triggers))
    settings.controls.emplace("trigger", *trigger);
  // 68: the least that holds a picture's leader; 16 000: beyond any jumbo frame.
  if (options.text("packet_size") != "auto")
    settings.packet_size = options.integer("packet_size", 68, 16000).value_or(0);
  settings.silence = options.number("silence", 0, 3600).value_or(settings.silence);
  settings.buffers = options.integer("buffers", 2, 1000).value_or(settings.buffers);
  settings.resend = options.boolean("resend").value_or(settings.resend);
  settings.ptp = options.boolean("ptp").value_or(settings.ptp);
  if (const auto good = options.done(); !good) return fail(good.error());
  return settings;
}

Result<void> apply_settings(const AravisSettings& settings, ArvDevice* device, const Features& features) {
  // A stream that a crashed program left running would lock what is set now.
  static_cast<void>(features.execute("AcquisitionStop"));
  if (!settings.user_set.empty()) {
    if (auto set = features.set_text("UserSetSelector", settings.user_set); !set) return set;
    if (auto loaded = features.execute("UserSetLoad"); !loaded) return loaded;
  }
  if (auto set = set_region(settings, features); !set) return set;
  if (auto set = set_format(settings, features); !set) return set;
  features.set_first_choice("AcquisitionMode", {"Continuous"});
  if (auto set = set_controls(settings, features); !set) return set;
  if (settings.ptp) {
    if (auto set = enable_ptp(features); !set) return set;
  }
  if (!settings.features.empty()) {
    GErrorHolder error;
    if (!arv_device_set_features_from_string(device, settings.features.c_str(), error.out())) {
      return fail(ErrorCode::config, "features", error.text(), "they are written \"Name=value Name=value\"");
    }
  }
  return {};
}

}  // namespace ca2
