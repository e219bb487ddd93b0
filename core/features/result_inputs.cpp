#include "core/features/result_inputs.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/features/search.h"
#include "core/io/content_digest.h"
#include "core/types/text.h"

namespace ca2 {
namespace {

using Digests = std::map<std::string, std::string>;

std::string hexadecimal(std::uint64_t digest) {
  return formatted("%016llx", static_cast<unsigned long long>(digest));
}

/// The part as it would be written.
std::string digest_of(const Rig& part) {
  return hexadecimal(ContentDigest::of(write_rig(part)));
}

/// To 1e-9: the last bits of a rotation are the processor's that read it.
std::string digest_of(const std::vector<RigExtrinsic>& extrinsics) {
  std::string text;
  const auto add = [&](double value) { text += formatted(" %lld", std::llround(1e9 * value)); };
  for (const RigExtrinsic& extrinsic : extrinsics) {
    text += extrinsic.parent + " " + extrinsic.child + (extrinsic.fixed ? " fixed" : "");
    for (const double value : extrinsic.T_parent_child.R.reshaped()) add(value);
    for (const double value : extrinsic.T_parent_child.t) add(value);
    text += "\n";
  }
  return hexadecimal(ContentDigest::of(text));
}

Digests rig_digests(const Rig& rig) {
  Digests digests;
  Rig part;
  part.board = rig.board;
  digests["board"] = digest_of(part);
  digests["extrinsics"] = digest_of(rig.extrinsics);
  for (auto [name, camera] : rig.cameras) {
    camera.source.clear();
    part = {};
    part.cameras[name] = camera;
    digests["cameras." + name] = digest_of(part);
  }
  for (auto [name, lidar] : rig.lidars) {
    lidar.source.clear();
    for (std::string* file : {&lidar.metadata, &lidar.calibration}) {
      if (!file->empty()) *file = "given";
    }
    part = {};
    part.lidars[name] = lidar;
    digests["lidars." + name] = digest_of(part);
  }
  return digests;
}

std::string digest_of(const SensorFile& file) {
  if (!file.content) return "none";
  if (!file.pick) return hexadecimal(*file.content);
  const Pick& pick = *file.pick;
  return hexadecimal(*file.content) + formatted("-%d-%d-%.17g", pick.row, pick.column, pick.radius);
}

/// "the board", "camera 'left'"
std::string part_in_words(const std::string& part) {
  if (part == "board") return "the board";
  if (part == "extrinsics") return "what is known of the extrinsics";
  const std::size_t dot = part.find('.');
  return (part.compare(0, dot, "cameras") == 0 ? "camera '" : "lidar '") + part.substr(dot + 1) + "'";
}

/// "view 3 is", "views 3, 9-12 are"
std::string views_in_words(const std::vector<int>& ids) {
  std::string list;
  for (std::size_t i = 0; i < ids.size();) {
    std::size_t last = i;
    while (last + 1 < ids.size() && ids[last + 1] == ids[last] + 1) ++last;
    list += (list.empty() ? "" : ", ") + std::to_string(ids[i]);
    if (last > i) list += "-" + std::to_string(ids[last]);
    i = last + 1;
  }
  return ids.size() == 1 ? "view " + list + " is" : "views " + list + " are";
}

std::vector<std::string> rig_changes(const Digests& then, const Digests& now) {
  std::vector<std::string> changes;
  for (const auto& [part, digest] : then) {
    const auto found = now.find(part);
    if (found == now.end()) {
      changes.push_back(part_in_words(part) + " is gone");
    } else if (found->second != digest) {
      changes.push_back(part_in_words(part) + " is another");
    }
  }
  for (const auto& [part, digest] : now) {
    if (!then.count(part)) changes.push_back(part_in_words(part) + " is new");
  }
  return changes;
}

/// Sensors that are in both: of those that came or went the rig tells.
std::set<std::string> common_sensors(const Digests& then, const Digests& now) {
  std::set<std::string> sensors;
  for (const auto& [part, digest] : then) {
    const std::size_t dot = part.find('.');
    if (dot != std::string::npos && now.count(part)) sensors.insert(part.substr(dot + 1));
  }
  return sensors;
}

bool differ(const Digests& then, const Digests& now, const std::set<std::string>& sensors) {
  const auto text = [](const Digests& digests, const std::string& sensor) {
    const auto found = digests.find(sensor);
    return found == digests.end() ? std::string() : found->second;
  };
  return std::any_of(sensors.begin(), sensors.end(),
                     [&](const std::string& sensor) { return text(then, sensor) != text(now, sensor); });
}

std::vector<int> changed_views(const CalibrationInputs& then, const CalibrationInputs& now) {
  const std::set<std::string> sensors = common_sensors(then.rig, now.rig);
  std::vector<int> ids;
  for (const auto& [id, files] : then.views) {
    const auto found = now.views.find(id);
    if (found != now.views.end() && !files.empty() && differ(files, found->second, sensors))
      ids.push_back(id);
  }
  return ids;
}

std::vector<int> missed_views(const Calibration& calibration, const Session& session) {
  std::vector<int> ids;
  for (const CalibratedView& view : calibration.views) {
    const auto is_it = [&](const SessionView& other) { return other.id == view.id; };
    if (view.used && std::none_of(session.views.begin(), session.views.end(), is_it)) ids.push_back(view.id);
  }
  return ids;
}

std::vector<int> new_views(const CalibrationInputs& then, const Session& session) {
  std::vector<int> ids;
  for (const SessionView& view : session.views) {
    if (!then.views.count(view.id)) ids.push_back(view.id);
  }
  return ids;
}

}  // namespace

CalibrationInputs result_inputs(const Session& session, const std::vector<int>& asked, bool cache) {
  CalibrationInputs inputs{rig_digests(session.rig), {}};
  for (const SessionView& view : session.views) inputs.views[view.id];
  Result<std::vector<SensorFile>> files = list_files(session, asked);
  if (!files) return inputs;
  add_contents(session, *files, cache);
  for (const SensorFile& file : *files) {
    inputs.views[session.views[file.view].id][file.sensor] = digest_of(file);
  }
  return inputs;
}

std::optional<Problem> outdated_result(const Calibration& calibration, const Session& session) {
  if (!calibration.inputs) return std::nullopt;
  const CalibrationInputs& then = *calibration.inputs;
  std::vector<int> asked;
  for (const SessionView& view : session.views) {
    const auto known = then.views.find(view.id);
    if (known != then.views.end() && !known->second.empty()) asked.push_back(view.id);
  }
  CalibrationInputs now{rig_digests(session.rig), {}};
  if (!asked.empty()) now = result_inputs(session, asked);
  std::vector<std::string> changes = rig_changes(then.rig, now.rig);
  const auto add = [&](const std::vector<int>& ids, const char* what) {
    if (!ids.empty()) changes.push_back(views_in_words(ids) + what);
  };
  add(changed_views(then, now), " changed");
  add(missed_views(calibration, session), " gone");
  add(new_views(then, session), " new");
  if (changes.empty()) return std::nullopt;
  std::string list;
  for (const std::string& change : changes) list += (list.empty() ? "" : ", ") + change;
  return Problem{(session.directory / "result.yaml").string(),
                 "the session is not what this result was made of any more: " + list,
                 "run `ca2 solve " + session.directory.string() + "`"};
}

}  // namespace ca2
