#include "drivers/camera/aravis/camera_controls.h"

#include <algorithm>

#include "core/types/text.h"
#include "drivers/camera/option_reader.h"

namespace ca2 {
namespace {

struct NumberControl {
  const char* name;
  Feature feature;
  std::optional<Feature> automatic;  ///< the enumeration Off, Once, Continuous beside it
};

constexpr NumberControl number_controls[] = {{"exposure_us", Feature::exposure, Feature::exposure_auto},
                                             {"gain_db", Feature::gain, Feature::gain_auto},
                                             {"frame_rate", Feature::frame_rate, std::nullopt}};

constexpr std::string_view trigger_words[] = {"off", "software"};

bool triggered(const Features& features) {
  return features.text("TriggerMode") == "On" && features.text("TriggerSource") == "Software";
}

/// Pictures come by themselves. A Manta is always triggered, by a source named "Freerun" or "FixedRate" (only
/// the latter heeds the frame rate); elsewhere it means that every trigger is off.
Result<void> free_run(const Features& features, bool at_fixed_rate) {
  if (!features.has("TriggerMode")) return {};
  const std::vector<std::string> sources = features.choices("TriggerSource");
  const char* source = at_fixed_rate ? "FixedRate" : "Freerun";
  if (std::find(sources.begin(), sources.end(), source) != sources.end()) {
    if (features.has("TriggerSelector")) {
      if (auto set = features.set_text("TriggerSelector", "FrameStart"); !set) return set;
    }
    return features.set_text("TriggerSource", source);
  }
  if (!features.has("TriggerSelector")) return features.set_text("TriggerMode", "Off");
  for (const std::string& selector : features.choices("TriggerSelector")) {
    if (auto set = features.set_text("TriggerSelector", selector); !set) return set;
    if (!features.has("TriggerMode")) continue;
    if (auto set = features.set_text("TriggerMode", "Off"); !set) return set;
  }
  return {};
}

Result<void> software_trigger(const Features& features) {
  // Other triggers that stay on would have to come as well.
  if (auto set = free_run(features, false); !set) return set;
  features.set_first_choice("TriggerSelector", {"FrameStart", "FrameBurstStart", "AcquisitionStart"});
  if (auto set = features.set_text("TriggerSource", "Software"); !set) return set;
  // A trigger may then come while the last picture is read out.
  features.set_first_choice("TriggerOverlap", {"ReadOut", "PreviousFrame"});
  return features.set_text("TriggerMode", "On");
}

Result<void> write_frame_rate(const Features& features, double rate) {
  if (!triggered(features)) {
    if (auto set = free_run(features, true); !set) return set;
  }
  if (const char* automatic = features.name(Feature::frame_rate_auto)) {
    features.set_first_choice(automatic, {"Off"});
  }
  if (const char* enable = features.name(Feature::frame_rate_enable)) {
    if (auto set = features.set_boolean(enable, true); !set) return set;
  }
  return features.set_number(features.name(Feature::frame_rate), rate);
}

}  // namespace

std::map<std::string, CameraControl> read_controls(const Features& features) {
  std::map<std::string, CameraControl> controls;
  for (const NumberControl& control : number_controls) {
    const char* name = features.name(control.feature);
    if (!name) continue;
    CameraControl& out = controls[control.name];
    if (const auto value = features.number(name)) out.value = formatted("%.10g", *value);
    if (const auto limits = features.limits(name)) {
      out.limits = formatted("%.10g to %.10g", limits->least, limits->most);
    }
    const char* automatic = control.automatic ? features.name(*control.automatic) : nullptr;
    if (!automatic) continue;
    out.limits += ", auto";
    if (const auto mode = features.text(automatic); mode && *mode != "Off") out.value = "auto";
  }
  if (features.has(Feature::trigger_software)) {
    controls["trigger"] = {triggered(features) ? "software" : "off", "off, software", ""};
  }
  return controls;
}

Result<void> check_control(const std::map<std::string, CameraControl>& controls, const std::string& name,
                           const std::string& value) {
  std::vector<std::string_view> known;
  for (const auto& [control, state] : controls) known.push_back(control);
  OptionReader reader({{name, value}}, known);
  const auto control = controls.find(name);
  if (control != controls.end() && name == "trigger") reader.choice(name, trigger_words);
  const bool automatic = control != controls.end() && control->second.limits.ends_with(", auto");
  if (control != controls.end() && name != "trigger" && !(automatic && value == "auto")) {
    double least = 0, most = 0;
    if (std::sscanf(control->second.limits.c_str(), "%lf to %lf", &least, &most) == 2) {
      reader.number(name, least, most);
    } else {
      reader.number(name, -1e12, 1e12);
    }
  }
  if (const auto good = reader.done(); !good) return fail(ErrorCode::usage, good.error().problems);
  return {};
}

Result<void> write_control(const Features& features, const std::string& name, const std::string& value) {
  if (name == "trigger") return value == "software" ? software_trigger(features) : free_run(features, false);
  const auto* control = std::find_if(std::begin(number_controls), std::end(number_controls),
                                     [&](const NumberControl& c) { return c.name == name; });
  const char* feature = control == std::end(number_controls) ? nullptr : features.name(control->feature);
  if (!feature) return fail(ErrorCode::unavailable, name, "the camera has no such control");
  const char* automatic = control->automatic ? features.name(*control->automatic) : nullptr;
  if (value == "auto") return features.set_text(automatic ? automatic : feature, "Continuous");
  if (automatic) {
    if (auto set = features.set_text(automatic, "Off"); !set) return set;
  }
  const double number = std::strtod(value.c_str(), nullptr);
  if (control->feature == Feature::frame_rate) return write_frame_rate(features, number);
  return features.set_number(feature, number);
}

double expected_rate(const Features& features) {
  const auto source = features.text("TriggerSource");
  const bool by_itself = source == "Freerun" || source == "FixedRate";
  if (features.text("TriggerMode") == "On" && !by_itself) return 0;
  for (const Feature feature : {Feature::resulting_frame_rate, Feature::frame_rate}) {
    const char* name = features.name(feature);
    if (!name) continue;
    if (const auto rate = features.number(name); rate && *rate > 0) return *rate;
  }
  return 0;
}

}  // namespace ca2
