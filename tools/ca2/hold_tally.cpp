#include "tools/ca2/hold_tally.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/features/extract.h"
#include "core/geometry/plane.h"
#include "core/io/files.h"
#include "core/io/yaml.h"
#include "core/io/yaml_reader.h"
#include "core/types/text.h"
#include "tools/sim/truth_file.h"

namespace ca2 {
namespace {

// Motion of least jerk ends slowly: in its last fifth of a second the board comes closer by millimetres.
constexpr std::int64_t settling = 200'000'000;  // ns
// Beyond what noise, tremor and a rough patch do; nothing else in a room is so close to the board.
constexpr double same_place = 0.06, same_tilt = 0.15;  // m, rad

struct Span {
  std::int64_t first = std::numeric_limits<std::int64_t>::max(), last = 0;  ///< ns UTC
};

/// From the first to the last picture or scan that went into a view.
Result<Span> span_of(const std::filesystem::path& file) {
  const Result<std::string> text = read_text(file, max_yaml_bytes);
  if (!text) return fail(text.error());
  const Result<YamlNode> root = parse_yaml(*text, file.string());
  if (!root) return fail(root.error());
  YamlReader reader(file.string());
  Span span;
  const YamlNode* stamps = reader.map(&*root, "a view") ? reader.require(*root, "stamps", "a view") : nullptr;
  if (stamps && reader.map(stamps, "'stamps'")) {
    for (const YamlNode& sensor : stamps->items) {
      for (const YamlNode& item : sensor.items) {
        const auto time = reader.integer(&item, 0, std::numeric_limits<long long>::max());
        if (!time) continue;
        span.first = std::min<std::int64_t>(span.first, *time);
        span.last = std::max<std::int64_t>(span.last, *time);
      }
    }
  }
  if (!reader.problems().empty()) return fail(ErrorCode::data, reader.problems());
  return span;
}

/// A sight counts for what it is best at: corners for the place, a patch for its plane.
int wrong_sights(const ViewSights& view, const Rig& rig, const RecordedHold& hold) {
  int wrong = 0;
  std::size_t c = 0;
  for (const auto& [name, camera] : rig.cameras) {
    const auto& sight = view.cameras[c++];
    const auto truth = hold.T_sensor_board.find(name);
    if (!sight || !camera.intrinsics) continue;
    wrong += truth == hold.T_sensor_board.end() ||
             (sight->pose.T_camera_board.t - truth->second.t).norm() > same_place;
  }
  std::size_t l = 0;
  for (const auto& [name, lidar] : rig.lidars) {
    const auto& sights = view.lidars[l++];
    const auto truth = hold.T_sensor_board.find(name);
    if (sights.empty()) continue;
    wrong += truth == hold.T_sensor_board.end() ||
             std::none_of(sights.begin(), sights.end(), [&](const LidarSight& sight) {
               return std::abs(sight.plane.distance(truth->second.t)) < same_place &&
                      (sight.center - truth->second.t).norm() < rig.board.square * rig.board.columns &&
                      sight.plane.normal.dot(board_plane(truth->second).normal) > std::cos(same_tilt);
             });
  }
  return wrong;
}

}  // namespace

std::string HoldTally::text() const {
  return formatted(
      "holds: %d of %d captured, %d views while moving, %d wrong sights, %d captured twice; stored %.2f s "
      "after the board stood still at most",
      captured, holds, moving, wrong, twice, longest);
}

Result<std::optional<HoldTally>> tally_holds(const std::filesystem::path& truth, const Session& session,
                                             const std::map<int, std::int64_t>& stored) {
  const Result<std::vector<RecordedHold>> holds = read_true_holds(truth);
  if (!holds || holds->empty()) return std::optional<HoldTally>();
  HoldTally tally;
  tally.holds = static_cast<int>(holds->size());
  std::map<int, int> views_of_hold;
  for (const SessionView& view : session.views) {
    const auto time = stored.find(view.id);
    if (time == stored.end()) continue;  // of an earlier replay
    const Result<Span> span = span_of(view.directory / "view.yaml");
    if (!span) return fail(span.error());
    const auto hold = std::find_if(holds->begin(), holds->end(), [&](const RecordedHold& one) {
      return span->first >= one.from - settling && span->last <= one.to + settling;
    });
    if (hold == holds->end()) {
      ++tally.moving;
      continue;
    }
    ++views_of_hold[hold->id];
    tally.longest = std::max(tally.longest, 1e-9 * static_cast<double>(time->second - hold->from));
    const Result<ViewSights> sights = extract_view(session, view.id);
    tally.wrong += sights ? wrong_sights(*sights, session.rig, *hold) : 1;
  }
  tally.captured = static_cast<int>(views_of_hold.size());
  for (const auto& [hold, views] : views_of_hold) tally.twice += views > 1;
  return std::optional<HoldTally>(tally);
}

}  // namespace ca2
