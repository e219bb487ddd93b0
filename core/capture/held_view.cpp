#include "core/capture/held_view.h"

#include <algorithm>
#include <cmath>

#include "core/capture/gates.h"
#include "core/capture/picture_pairs.h"
#include "core/types/text.h"

namespace ca2 {
namespace {

// A hypothesis that the finder misses in more scans than this is not the board.
constexpr double least_presence = 0.6;
// Share of a hypothesis that must stand where nothing was before.
constexpr double least_novelty = 0.5;

/// Why a LiDAR's hypothesis is not the board; the later, the closer it came.
enum class Doubt { missing, moving, unknown, familiar, elsewhere, none };

struct Verdict {
  Doubt doubt = Doubt::missing;
  double merit = 0;  ///< ranks those without doubt
  double value = 0;  ///< m, for the person: motion, or how far it is from where a camera sees the board
};

class Collector {
 public:
  Collector(const Tracks& tracks, const HoldContext& context, bool at_once)
      : tracks_(tracks), context_(context), at_once_(at_once) {}

  HeldView run(std::int64_t since, std::int64_t newest) {
    std::vector<std::vector<const CameraObservation*>> pictures;
    for (const CameraTrack& camera : tracks_.cameras) {
      std::erase_if(pictures.emplace_back(camera.between(since, newest)),
                    [](const CameraObservation* picture) { return picture->image == nullptr; });
    }
    keep_pairs(pictures);
    for (std::size_t c = 0; c < pictures.size(); ++c) add_camera(c, std::move(pictures[c]));
    if (!view_.cameras.empty()) {
      for (std::size_t l = 0; l < tracks_.lidars.size(); ++l) add_lidar(l, since, newest);
    }
    settle();
    return std::move(view_);
  }

 private:
  void add_camera(std::size_t c, std::vector<const CameraObservation*> pictures) {
    const std::string& name = tracks_.camera_names[c];
    if (tracks_.cameras[c].too_slow() && !at_once_) {
      view_.gates[name] = too_slow_text(name, tracks_.cameras[c]);
      return;
    }
    HeldCamera held;
    held.pictures = std::move(pictures);
    if (held.pictures.empty()) return;
    held.corners = tracks_.cameras[c].mean_corners(held.pictures);
    const RigCamera& camera = context_.rig.cameras.at(name);
    if (camera.intrinsics) {
      const auto pose = estimate_board_pose(context_.rig.board, *camera.intrinsics, held.corners);
      if (!pose) {
        view_.gates[name] = pose.error().problems.front().what;
        return;
      }
      held.pose = *pose;
    }
    const std::string reason =
        judge_camera(name, context_.rig.board, held.pictures.back()->corners, held.pose);
    view_.gates[name] = reason;
    if (reason.empty()) view_.cameras.emplace(c, std::move(held));
  }

  /// The least disagreement with a camera whose extrinsics are known.
  std::optional<double> disagreement_of(std::size_t l, const LidarSight& sight, double& metres) const {
    std::optional<double> least;
    for (const auto& [c, camera] : view_.cameras) {
      const auto guess = context_.extrinsics.between(tracks_.camera_names[c], tracks_.lidar_names[l]);
      if (!guess || !camera.pose) continue;
      const double value = disagreement(*guess, camera.pose->T_camera_board, context_.rig.board, sight);
      if (least && *least < value) continue;
      least = value;
      metres = value * guess->distance;
    }
    return least;
  }

  Verdict judge(std::size_t l, const LidarHold& hold, const LidarSight& sight) const {
    if (hold.presence < least_presence) return {};
    if (hold.motion > context_.options.lidar_motion && !at_once_) return {Doubt::moving, 0, hold.motion};
    double metres = 0;
    const auto disagreement = disagreement_of(l, sight, metres);
    if (disagreement) {
      if (*disagreement > 1) return {Doubt::elsewhere, 0, metres};
      return {Doubt::none, 1 - *disagreement, 0};
    }
    if (context_.picks.contains(static_cast<int>(l))) return {Doubt::none, 1, 0};
    const double novelty = std::isnan(hold.novelty) ? 0 : hold.novelty;
    if (!at_once_ && std::isnan(hold.novelty)) return {Doubt::unknown, 0, 0};
    if (!at_once_ && novelty < least_novelty) return {Doubt::familiar, 0, 0};
    return {Doubt::none, sight.score * (0.2 + novelty), 0};
  }

  void add_lidar(std::size_t l, std::int64_t since, std::int64_t newest) {
    HeldLidar held;
    held.scans = tracks_.lidars[l].within(since, newest);
    const std::string& name = tracks_.lidar_names[l];
    Verdict best;
    for (const LidarHold& hold : LidarTrack::follow(held.scans)) {
      const LidarSight& sight = held.scans.back()->sights[hold.sight];
      const Verdict verdict = judge(l, hold, sight);
      if (verdict.doubt < best.doubt || (verdict.doubt == best.doubt && verdict.merit <= best.merit))
        continue;
      best = verdict;
      held.sight = &sight;
      held.motion = hold.motion;
    }
    std::string reason = doubt_text(name, best, held.scans.empty());
    // Scans in which nothing was found, or that were released, are not kept (LidarTrack).
    std::erase_if(held.scans, [](const LidarObservation* scan) { return scan->scan == nullptr; });
    if (reason.empty()) reason = judge_lidar(name, *held.sight);
    view_.gates[name] = reason;
    if (reason.empty()) view_.lidars.emplace(l, std::move(held));
  }

  static std::string doubt_text(const std::string& name, const Verdict& verdict, bool no_scans) {
    switch (verdict.doubt) {
      case Doubt::missing:
        return no_scans ? "no scans of " + name : name + " does not see the board";
      case Doubt::moving:
        return formatted("the board moves %.0f mm in %s; hold it still", 1e3 * verdict.value, name.c_str());
      case Doubt::unknown:
        return name + " is still learning what the room looks like";
      case Doubt::familiar:
        return name + " sees nothing of the board's size that was not there before: move the board";
      case Doubt::elsewhere:
        return formatted("what %s holds for the board is %.1f m from where the cameras see it", name.c_str(),
                         verdict.value);
      case Doubt::none:
        break;
    }
    return {};
  }

  void settle() {
    if (!view_.cameras.empty() && !view_.lidars.empty()) return;
    for (const auto& [name, reason] : view_.gates) {
      const bool is_lidar = context_.rig.lidars.contains(name);
      if (reason.empty() || is_lidar == view_.cameras.empty()) continue;
      view_.refusal += (view_.refusal.empty() ? "" : "; ") + reason;
    }
    if (view_.refusal.empty()) view_.refusal = "no camera sees the board";
  }

  const Tracks& tracks_;
  const HoldContext& context_;
  bool at_once_;
  HeldView view_;
};

}  // namespace

HeldView collect_view(const Tracks& tracks, const HoldContext& context, std::int64_t since,
                      std::int64_t newest, bool at_once) {
  return Collector(tracks, context, at_once).run(since, newest);
}

ViewPose pose_of(const HeldView& view, const Tracks& tracks) {
  ViewPose pose;
  pose.T_camera_board.resize(tracks.cameras.size());
  pose.corners.resize(tracks.cameras.size());
  for (const auto& [c, camera] : view.cameras) {
    pose.corners[c] = camera.corners;
    if (camera.pose) pose.T_camera_board[c] = camera.pose->T_camera_board;
  }
  for (const auto& [l, lidar] : view.lidars) pose.lidars.insert(static_cast<int>(l));
  return pose;
}

}  // namespace ca2
