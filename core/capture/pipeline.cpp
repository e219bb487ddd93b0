#include "core/capture/pipeline.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/capture/gates.h"
#include "core/capture/held_view.h"
#include "core/capture/next_view.h"
#include "core/capture/sensor_status.h"
#include "core/capture/stored_form.h"
#include "core/features/lidar_sights.h"
#include "core/types/counted.h"
#include "core/types/text.h"

namespace ca2 {
namespace {

// Planes take three views; before that nobody is told what fewer leave open, unless by asking for it.
constexpr std::size_t fewest_views = 3;
// What may do for who asks: the rim of a plate whose outline is known.
std::size_t fewest_for(const Board& board) {
  return board.outline ? 1 : fewest_views;
}
// While a hold is refused, it is looked at again so often: something in the way may go.
constexpr std::int64_t retry = 100'000'000;  // ns
// Where data comes late, a hold seems to end and to begin again: what was said of it is not said anew.
constexpr std::int64_t one_refusal = 3'000'000'000;  // ns

// Sensors deliver out of order by less; a clock that runs backwards by more was set.
constexpr std::int64_t set_back = 2'000'000'000;  // ns

/// How long since a hold was looked at, and what came of it. A hold lasts until the board moves on.
struct Hold {
  bool decided = false;  ///< captured, or not to be: nothing more happens until the board moves
  bool told = false;     ///< its refusal was said
  bool active = false;
  std::int64_t end = 0;    ///< ns: still until here, as far as is known
  std::int64_t tried = 0;  ///< ns
  std::string reason;      ///< of the refusal
};

enum class Request { none, when_still, at_once };

std::string same_pose(int id) {
  return formatted("view %d shows this pose already: move or tilt the board", id);
}

}  // namespace

struct CapturePipeline::State {
  Rig rig;
  CaptureOptions options;
  Tracks tracks;
  std::vector<ViewSights> views;
  KnownPoses known;
  KnownExtrinsics extrinsics;
  std::map<int, Pick> picks;  ///< by LiDAR
  std::int64_t picked = 0;    ///< ns
  int next_id = 1;
  std::optional<int> writing;  ///< the view that is being stored
  std::uint64_t solves = 0;
  std::optional<Calibration> calibration;
  std::string verdict;
  Request request = Request::none;
  std::int64_t requested = 0;  ///< ns: when_still
  Hold hold;
  Assessment assessment;
  std::int64_t now = 0;
  std::string last_event;
  std::string refused;            ///< the newest refusal, or what will be said of the view just taken
  std::int64_t refused_time = 0;  ///< ns
  std::optional<NextPose> next;

  State(Rig rig_in, CaptureOptions options_in, std::vector<ViewSights> views_in)
      : rig(std::move(rig_in)), options(options_in), views(std::move(views_in)), extrinsics(rig) {
    for (const auto& [name, camera] : rig.cameras) {
      tracks.camera_names.push_back(name);
      tracks.cameras.emplace_back(rig.board);
    }
    for (const auto& [name, lidar] : rig.lidars) {
      tracks.lidar_names.push_back(name);
      tracks.lidars.emplace_back();
    }
    for (const ViewSights& view : views) {
      known.add(pose_of_view(view, have_intrinsics()));
      next_id = std::max(next_id, view.id + 1);
    }
  }

  std::vector<bool> have_intrinsics() const {
    std::vector<bool> have;
    for (const auto& [name, camera] : rig.cameras) have.push_back(camera.intrinsics.has_value());
    return have;
  }

  void say(CaptureActions& actions, std::int64_t time, const char* kind, std::string text) {
    last_event = text;
    actions.emplace_back(CaptureEvent{time, kind, std::move(text)});
  }

  void guide() { next = next_view({rig, tracks, options}, calibration, views); }

  void request_solve(CaptureActions& actions, std::size_t least = fewest_views) {
    if (views.size() < least) return;
    actions.emplace_back(SolveViews{++solves, std::make_shared<const Rig>(rig),
                                    std::make_shared<const std::vector<ViewSights>>(views)});
  }

  /// Everything that a new observation or the time may change.
  void advance(std::int64_t time, CaptureActions& actions) {
    if (time < now - set_back) {
      now = time;
      hold = {};
      picked = std::min(picked, time);
    }
    now = std::max(now, time);
    look_back_far_enough(tracks, options, now);
    assessment = assess(tracks, options, now);
    const bool still =
        assessment.phase == Assessment::Phase::holding || assessment.phase == Assessment::Phase::ready;
    // Still since before the end of what was known of the hold: the same one.
    if (hold.active && (!still || assessment.since > hold.end)) hold = {};
    if (assessment.phase == Assessment::Phase::moving && assessment.since > picked) picks.clear();
    release_unneeded(tracks, options, assessment, needed_since());
    if (assessment.phase != Assessment::Phase::ready) return;
    hold.active = true;
    hold.end = std::max(hold.end, assessment.newest);
    const bool wanted = options.automatic && !hold.decided;
    if (!wanted && request != Request::when_still) return;
    if (writing || assessment.newest - hold.tried < retry) return;
    const std::int64_t since = std::max(assessment.since, needed_since().value_or(assessment.since));
    if (hold.decided && 1e-9 * static_cast<double>(assessment.newest - since) < options.dwell) return;
    hold.tried = assessment.newest;
    attempt(since, assessment.newest, actions);
  }

  /// ns: once it is decided what becomes of a hold, what was seen before is not needed; who asks for a view
  /// of it all the same gets one of the dwell that follows. Nothing: it is not decided.
  std::optional<std::int64_t> needed_since() const {
    if (!hold.decided) return std::nullopt;
    return request == Request::when_still ? requested : std::numeric_limits<std::int64_t>::max();
  }

  /// Takes the view from `since` to `newest`, or says why not.
  void attempt(std::int64_t since, std::int64_t newest, CaptureActions& actions) {
    const bool manual = request != Request::none, at_once = request == Request::at_once;
    const HeldView view = collect_view(tracks, {rig, options, extrinsics, picks}, since, newest, at_once);
    ViewPose pose = pose_of(view, tracks);
    std::string refusal = view.refusal;
    if (refusal.empty() && static_cast<int>(views.size()) >= options.max_views) {
      refusal = "the session has " + counted(options.max_views, "view") + ", the most it may have";
    }
    if (refusal.empty() && !manual) {
      if (const auto same = known.find_same(pose)) {
        refusal = same_pose(*same);
        hold.decided = true;
      }
    }
    if (!refusal.empty()) {
      hold.reason = refusal;
      const bool again = refusal == refused && newest - refused_time < one_refusal;
      if ((!hold.told && !again) || manual) say(actions, newest, "rejected", refusal);
      refused = std::move(refusal);
      refused_time = newest;
      hold.told = true;
      if (at_once) request = Request::none;
      return;
    }
    request = Request::none;
    hold.decided = true;
    refused = same_pose(next_id);
    refused_time = newest;
    pose.id = next_id;
    known.add(std::move(pose));
    writing = next_id;
    actions.emplace_back(stored_form(view, tracks, picks, next_id++, !manual));
    picks.clear();
  }

  /// The newest picture and scan that show the board, moving or not.
  void attempt_at_once(std::int64_t time, CaptureActions& actions) {
    std::int64_t since = std::numeric_limits<std::int64_t>::max(), newest = 0;
    for (const auto& still : assessment.cameras) {
      if (still) since = std::min(since, still->newest), newest = std::max(newest, still->newest);
    }
    if (newest == 0) {
      request = Request::none;
      say(actions, time, "rejected", "no camera sees the board");
      return;
    }
    std::int64_t revolution = 0;
    for (const LidarTrack& lidar : tracks.lidars) {
      if (lidar.newest() && !lidar.rhythm().silent(now)) revolution = std::max(revolution, lidar.period());
    }
    // Long enough that each LiDAR has one whole revolution in it.
    attempt(since - 2 * revolution, newest + revolution, actions);
  }

  bool reached() const {
    if (!calibration) return false;
    return worst_translation() <= options.target_sigma_translation &&
           worst_rotation() <= options.target_sigma_rotation;
  }
  double worst_translation() const {
    double worst = 0;
    for (const CalibratedTransform& t : calibration->transforms)
      worst = std::max(worst, t.sigma_translation());
    return worst;
  }
  double worst_rotation() const {
    double worst = 0;
    for (const CalibratedTransform& t : calibration->transforms) worst = std::max(worst, t.sigma_rotation());
    return worst;
  }
  int used_views() const {
    if (!calibration) return 0;
    return static_cast<int>(std::count_if(calibration->views.begin(), calibration->views.end(),
                                          [](const CalibratedView& view) { return view.used; }));
  }

  void describe(std::int64_t time, CaptureStatus& status) const {
    using Phase = Assessment::Phase;
    const Assessment current = time > now ? assess(tracks, options, time) : assessment;
    status.progress = current.phase == Phase::absent ? 0 : current.progress;
    if (writing) {
      status.state = CaptureState::capturing;
      status.reason = formatted("writing view %d", *writing);
    } else if (hold.active && hold.decided && current.phase != Phase::absent && request == Request::none) {
      status.state = hold.reason.empty() ? CaptureState::captured : CaptureState::holding;
      status.reason = hold.reason.empty() ? "captured: show the next pose" : hold.reason;
    } else if (current.phase == Phase::absent) {
      status.state = reached() ? CaptureState::done : CaptureState::waiting;
      status.reason = reached() ? "the target is reached" : current.reason;
    } else if (current.phase == Phase::moving) {
      status.state = CaptureState::moving;
      status.reason = current.reason;
    } else {
      status.state = CaptureState::holding;
      status.reason = !hold.reason.empty()      ? hold.reason
                      : !current.reason.empty() ? current.reason
                      : options.automatic       ? "hold it still"
                                                : "still: capture when you like";
    }
  }
};

CapturePipeline::CapturePipeline(Rig rig, CaptureOptions options, std::vector<ViewSights> views)
    : state_(std::make_unique<State>(std::move(rig), options, std::move(views))) {}

CapturePipeline::~CapturePipeline() = default;

CaptureActions CapturePipeline::add(const CameraObservation& observation) {
  CaptureActions actions;
  const auto index = static_cast<std::size_t>(observation.camera);
  if (observation.image) {
    RigCamera& camera = state_->rig.cameras.at(state_->tracks.camera_names[index]);
    if (camera.width == 0) camera.width = observation.image->width, camera.height = observation.image->height;
  }
  state_->tracks.cameras[index].add(observation);
  state_->advance(observation.time, actions);
  return actions;
}

CaptureActions CapturePipeline::add(const LidarObservation& observation) {
  CaptureActions actions;
  const auto index = static_cast<std::size_t>(observation.lidar);
  const auto pick = state_->picks.find(observation.lidar);
  if (pick == state_->picks.end() || !observation.searched) {
    state_->tracks.lidars[index].add(observation);
  } else {
    LidarObservation picked = observation;
    picked.sights.clear();
    picked.novelty.clear();
    if (auto sight = picked_sight(*observation.scan, state_->rig.board, pick->second)) {
      picked.sights.push_back(std::move(*sight));
      picked.novelty.push_back(1);
    }
    state_->tracks.lidars[index].add(picked);
  }
  state_->advance(observation.time, actions);
  return actions;
}

CaptureActions CapturePipeline::tick(std::int64_t now) {
  CaptureActions actions;
  state_->advance(now, actions);
  return actions;
}

CaptureActions CapturePipeline::capture(std::int64_t time, bool now) {
  CaptureActions actions;
  state_->now = std::max(state_->now, time);
  if (state_->writing) {
    state_->say(actions, time, "rejected", "a view is being written: ask again");
    return actions;
  }
  state_->request = now ? Request::at_once : Request::when_still;
  state_->requested = state_->now;
  state_->hold.tried = 0;
  if (now)
    state_->attempt_at_once(time, actions);
  else
    state_->advance(time, actions);
  return actions;
}

CaptureActions CapturePipeline::set_automatic(std::int64_t time, bool on) {
  CaptureActions actions;
  state_->options.automatic = on;
  state_->say(actions, time, "automatic", on ? "captures by itself" : "captures when asked");
  return actions;
}

CaptureActions CapturePipeline::pick(std::int64_t time, int lidar, int row, int column, double radius) {
  CaptureActions actions;
  const LidarTrack& track = state_->tracks.lidars[static_cast<std::size_t>(lidar)];
  const Pick pick{row, column, radius};
  const auto sight = track.newest()
                         ? picked_sight(*track.newest()->scan, state_->rig.board, pick)
                         : Result<LidarSight>(fail(ErrorCode::unavailable, "", "there is no scan yet"));
  if (!sight) {
    state_->say(actions, time, "rejected", sight.error().text());
    return actions;
  }
  state_->picks[lidar] = pick;
  state_->picked = time;
  state_->say(actions, time, "picked",
              formatted("the board is %.2f m away in %s", sight->center.norm(),
                        state_->tracks.lidar_names[static_cast<std::size_t>(lidar)].c_str()));
  return actions;
}

CaptureActions CapturePipeline::drop(std::int64_t time, int id) {
  CaptureActions actions;
  const auto erased = std::erase_if(state_->views, [&](const ViewSights& view) { return view.id == id; });
  if (erased == 0) {
    state_->say(actions, time, "rejected", formatted("there is no view %d", id));
    return actions;
  }
  state_->known.remove(id);
  actions.emplace_back(DropView{id});
  state_->say(actions, time, "dropped", formatted("view %d is dropped", id));
  if (state_->views.size() < fewest_views) {
    state_->calibration.reset();
    state_->verdict.clear();
  }
  state_->guide();
  state_->request_solve(actions);
  return actions;
}

CaptureActions CapturePipeline::solve(std::int64_t time) {
  CaptureActions actions;
  const std::size_t least = fewest_for(state_->rig.board);
  state_->request_solve(actions, least);
  if (actions.empty()) {
    state_->say(
        actions, time, "rejected",
        formatted("%s %s too few: capture at least %zu", counted(state_->views.size(), "view").c_str(),
                  state_->views.size() == 1 ? "is" : "are", least));
  }
  return actions;
}

CaptureActions CapturePipeline::stored(std::int64_t time, int id, Result<ViewSights> answer) {
  CaptureActions actions;
  if (state_->writing == id) state_->writing.reset();
  if (!answer) {
    state_->known.remove(id);
    state_->hold.reason = formatted("view %d was not stored: ", id) + answer.error().problems.front().what;
    state_->say(actions, time, "failed", answer.error().text());
    return actions;
  }
  answer->id = id;
  if (const std::string refusal = judge_stored(state_->rig, *answer); !refusal.empty()) {
    state_->known.remove(id);
    state_->hold.reason = refusal;
    actions.emplace_back(DropView{id});
    state_->say(actions, time, "rejected", refusal);
    return actions;
  }
  state_->views.push_back(std::move(*answer));
  state_->guide();
  state_->say(actions, time, "captured", formatted("view %d is stored", id));
  state_->request_solve(actions);
  return actions;
}

CaptureActions CapturePipeline::solved(std::int64_t time, std::uint64_t number,
                                       const Result<Calibration>& answer) {
  CaptureActions actions;
  if (number != state_->solves) return actions;  // of views that have changed since
  if (!answer) {
    state_->verdict = answer.error().text();
    state_->calibration.reset();
    state_->say(actions, time, "refused", state_->verdict);
    return actions;
  }
  state_->calibration = *answer;
  state_->verdict = answer->observability.verdict;
  state_->extrinsics.update(*answer);
  state_->guide();
  state_->say(actions, time, "solved",
              formatted("%d of %s: sigma %.2f mm, %.2f mrad, %s", state_->used_views(),
                        counted(state_->views.size(), "view").c_str(), 1e3 * state_->worst_translation(),
                        1e3 * state_->worst_rotation(), state_->verdict.c_str()));
  return actions;
}

CaptureStatus CapturePipeline::status(std::int64_t now) const {
  CaptureStatus status;
  const State& s = *state_;
  s.describe(now, status);
  status.automatic = s.options.automatic;
  status.views = static_cast<int>(s.views.size());
  status.used = s.used_views();
  for (std::size_t c = 0; c < s.tracks.cameras.size(); ++c)
    status.sensors.push_back(camera_status(s.tracks, c, s.options, now));
  for (std::size_t l = 0; l < s.tracks.lidars.size(); ++l)
    status.sensors.push_back(lidar_status(s.tracks, l, s.options, now));
  status.last_event = s.last_event;
  if (s.calibration) {
    status.sigma_translation = s.worst_translation();
    status.sigma_rotation = s.worst_rotation();
  }
  status.target_translation = s.options.target_sigma_translation;
  status.target_rotation = s.options.target_sigma_rotation;
  status.verdict = s.verdict;
  status.next = s.next;
  return status;
}

const Calibration* CapturePipeline::calibration() const {
  return state_->calibration ? &*state_->calibration : nullptr;
}

}  // namespace ca2
