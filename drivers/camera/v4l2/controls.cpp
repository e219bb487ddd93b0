#include "drivers/camera/v4l2/controls.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>

#include "core/types/text.h"
#include "drivers/camera/option_reader.h"

namespace ca2 {
namespace {

constexpr double exposure_unit = 100;  // us

/// An automatic that overrules a value.
struct Automatic {
  std::uint32_t value, automatic;
  std::int64_t off;
};
constexpr Automatic automatics[] = {
    {V4L2_CID_EXPOSURE_ABSOLUTE, V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL},
    {V4L2_CID_EXPOSURE, V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL},
    {V4L2_CID_GAIN, V4L2_CID_AUTOGAIN, 0},
    {V4L2_CID_FOCUS_ABSOLUTE, V4L2_CID_FOCUS_AUTO, 0},
    {V4L2_CID_WHITE_BALANCE_TEMPERATURE, V4L2_CID_AUTO_WHITE_BALANCE, 0},
    {V4L2_CID_RED_BALANCE, V4L2_CID_AUTO_WHITE_BALANCE, 0},
    {V4L2_CID_BLUE_BALANCE, V4L2_CID_AUTO_WHITE_BALANCE, 0}};

bool switches(std::uint32_t id) {
  return std::any_of(std::begin(automatics), std::end(automatics),
                     [&](const Automatic& a) { return a.automatic == id; });
}

/// "White Balance, Automatic" is "white_balance_automatic".
std::string folded(const char* name) {
  std::string out;
  for (; *name; ++name) {
    if (std::isalnum(static_cast<unsigned char>(*name))) {
      out += static_cast<char>(std::tolower(static_cast<unsigned char>(*name)));
    } else if (!out.empty() && out.back() != '_') {
      out += '_';
    }
  }
  while (!out.empty() && out.back() == '_') out.pop_back();
  return out;
}

}  // namespace

V4l2Controls::V4l2Controls(const V4l2Device& device) : device_(device) {
  v4l2_query_ext_ctrl query{};
  query.id = V4L2_CTRL_FLAG_NEXT_CTRL;
  // A driver that hands out the same control for ever must not hang us.
  for (int i = 0; i < 1000 && device.call(VIDIOC_QUERY_EXT_CTRL, &query) == 0; ++i) {
    const bool usable = !(query.flags & (V4L2_CTRL_FLAG_DISABLED | V4L2_CTRL_FLAG_READ_ONLY));
    const bool number = query.type == V4L2_CTRL_TYPE_INTEGER || query.type == V4L2_CTRL_TYPE_BOOLEAN ||
                        query.type == V4L2_CTRL_TYPE_MENU || query.type == V4L2_CTRL_TYPE_INTEGER_MENU ||
                        query.type == V4L2_CTRL_TYPE_INTEGER64;
    if (usable && number && query.elems <= 1) {
      query.name[sizeof query.name - 1] = '\0';
      entries_[folded(query.name)] = {query.id, query.type, query.minimum, query.maximum,
                                      static_cast<std::int64_t>(std::max<__u64>(query.step, 1))};
    }
    query.id |= V4L2_CTRL_FLAG_NEXT_CTRL;
  }
}

const V4l2Controls::Entry* V4l2Controls::find(std::uint32_t id) const {
  for (const auto& [name, entry] : entries_) {
    if (entry.id == id) return &entry;
  }
  return nullptr;
}

bool V4l2Controls::get(std::uint32_t id, std::int64_t& value) const {
  const Entry* entry = find(id);
  if (!entry) return false;
  v4l2_ext_control control{};
  control.id = id;
  v4l2_ext_controls list{};
  list.count = 1;
  list.controls = &control;
  if (device_.call(VIDIOC_G_EXT_CTRLS, &list) != 0) return false;
  value = entry->type == V4L2_CTRL_TYPE_INTEGER64 ? control.value64 : control.value;
  return true;
}

Result<void> V4l2Controls::set(const std::string& name, std::uint32_t id, std::int64_t value) const {
  const Entry* entry = find(id);
  v4l2_ext_control control{};
  control.id = id;
  if (entry && entry->type == V4L2_CTRL_TYPE_INTEGER64) {
    control.value64 = value;
  } else {
    control.value = static_cast<__s32>(value);
  }
  v4l2_ext_controls list{};
  list.count = 1;
  list.controls = &control;
  const int code = device_.call(VIDIOC_S_EXT_CTRLS, &list);
  if (code == 0) return {};
  if (code == EACCES) {
    return fail(ErrorCode::unavailable, device_.node(), "control '" + name + "' is not active now",
                "an automatic has it: switch that off");
  }
  return fail(v4l2_error(device_.node(), "set control '" + name + "'", code));
}

std::map<std::string, CameraControl> V4l2Controls::read() const {
  std::map<std::string, CameraControl> out;
  for (const auto& [name, entry] : entries_) {
    CameraControl& control = out[name];
    control.limits =
        formatted("%lld to %lld", static_cast<long long>(entry.least), static_cast<long long>(entry.most));
    if (entry.step > 1) control.limits += formatted(" in steps of %lld", static_cast<long long>(entry.step));
    std::int64_t value = 0;
    if (get(entry.id, value)) control.value = std::to_string(value);
  }
  if (const Entry* entry = find(V4L2_CID_EXPOSURE_ABSOLUTE)) {
    CameraControl& control = out["exposure_us"];
    control.limits = formatted("%g to %g, auto", exposure_unit * static_cast<double>(entry->least),
                               exposure_unit * static_cast<double>(entry->most));
    const double now = exposure();
    control.value = now > 0 ? formatted("%.10g", 1e6 * now) : "auto";
  }
  return out;
}

Result<void> V4l2Controls::check(const std::string& name, const std::string& value) const {
  const Entry* exposure = find(V4L2_CID_EXPOSURE_ABSOLUTE);
  std::vector<std::string_view> known;
  for (const auto& [control, entry] : entries_) known.push_back(control);
  if (exposure) known.push_back("exposure_us");
  OptionReader reader({{name, value}}, known);
  const auto entry = entries_.find(name);
  if (entry != entries_.end()) {
    const auto bounded = [](std::int64_t limit) {
      return static_cast<int>(std::clamp<std::int64_t>(limit, INT32_MIN, INT32_MAX));
    };
    reader.integer(name, bounded(entry->second.least), bounded(entry->second.most));
  } else if (exposure && name == "exposure_us" && value != "auto") {
    reader.number(name, exposure_unit * static_cast<double>(exposure->least),
                  exposure_unit * static_cast<double>(exposure->most));
  }
  if (const auto good = reader.done(); !good) return fail(ErrorCode::usage, good.error().problems);
  return {};
}

Result<void> V4l2Controls::write_exposure(const std::string& value) const {
  if (value == "auto") {
    // Most UVC cameras call their automatic "aperture priority" and refuse the one named automatic.
    if (set("exposure_us", V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_APERTURE_PRIORITY)) return {};
    return set("exposure_us", V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_AUTO);
  }
  if (find(V4L2_CID_EXPOSURE_AUTO)) {
    if (auto off = set("exposure_us", V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL); !off) return off;
  }
  if (find(V4L2_CID_EXPOSURE_AUTO_PRIORITY)) {
    // The frame rate stays what was asked for.
    static_cast<void>(set("exposure_us", V4L2_CID_EXPOSURE_AUTO_PRIORITY, 0));
  }
  return set("exposure_us", V4L2_CID_EXPOSURE_ABSOLUTE,
             std::llround(std::strtod(value.c_str(), nullptr) / exposure_unit));
}

Result<void> V4l2Controls::write(const std::string& name, const std::string& value) const {
  if (name == "exposure_us") return write_exposure(value);
  const auto entry = entries_.find(name);
  if (entry == entries_.end()) return fail(ErrorCode::usage, name, "the camera has no such control");
  for (const Automatic& automatic : automatics) {
    if (automatic.value != entry->second.id || !find(automatic.automatic)) continue;
    if (auto off = set(name, automatic.automatic, automatic.off); !off) return off;
  }
  std::int64_t number = 0;
  std::from_chars(value.data(), value.data() + value.size(), number);
  return set(name, entry->second.id, number);
}

Result<void> V4l2Controls::write(const std::map<std::string, std::string>& values) const {
  for (const bool first : {true, false}) {
    for (const auto& [name, value] : values) {
      const auto entry = entries_.find(name);
      const bool is_switch = entry != entries_.end() && switches(entry->second.id);
      if (is_switch != first) continue;
      if (auto good = check(name, value); !good) return good;
      if (auto written = write(name, value); !written) return written;
    }
  }
  return {};
}

double V4l2Controls::exposure() const {
  std::int64_t mode = V4L2_EXPOSURE_MANUAL, value = 0;
  get(V4L2_CID_EXPOSURE_AUTO, mode);
  const bool fixed = mode == V4L2_EXPOSURE_MANUAL || mode == V4L2_EXPOSURE_SHUTTER_PRIORITY;
  if (!fixed || !get(V4L2_CID_EXPOSURE_ABSOLUTE, value)) return 0;
  return 1e-6 * exposure_unit * static_cast<double>(value);
}

}  // namespace ca2
