#include "core/capture/assess.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "core/types/text.h"

namespace ca2 {
namespace {

// Of the dwell: before that it may only have slowed down.
constexpr double stopped = 0.25;
// Of every camera: what fewer pictures show may just have passed by.
constexpr std::size_t fewest_pictures = 3;
// Of the slowest camera: a hold's pictures, those that another camera lags behind, and what jitters.
constexpr double periods_kept = 4.5;
// Of the scans that fit into the dwell; the others may have begun before it, or be lost.
constexpr double enough_scans = 0.7;
// When a hold began is seen while it lasts, and differently by every picture: by less than this.
constexpr std::int64_t settling = 150'000'000;  // ns
// The same of a hold that has lasted for a while: by a picture or two.
constexpr std::int64_t settled = 60'000'000;  // ns

std::string silent_sensors(const Tracks& tracks, std::int64_t now) {
  std::string list;
  const auto add = [&](const std::string& name, const Rhythm& rhythm) {
    if (rhythm.silent(now)) list += (list.empty() ? "" : ", ") + name;
  };
  for (std::size_t i = 0; i < tracks.cameras.size(); ++i)
    add(tracks.camera_names[i], tracks.cameras[i].rhythm());
  for (std::size_t i = 0; i < tracks.lidars.size(); ++i)
    add(tracks.lidar_names[i], tracks.lidars[i].rhythm());
  return list;
}

/// Those that hold up nobody and of which no view can have pictures.
std::string slow_cameras(const Tracks& tracks, std::int64_t now) {
  std::string list;
  for (std::size_t i = 0; i < tracks.cameras.size(); ++i) {
    const Rhythm& rhythm = tracks.cameras[i].rhythm();
    if (!tracks.cameras[i].too_slow() || rhythm.silent(now)) continue;
    list += (list.empty() ? "" : "; ") + too_slow_text(tracks.camera_names[i], tracks.cameras[i]);
  }
  return list;
}

std::string hold_it_still(const Tracks& tracks, std::size_t slowest, double dwell) {
  const double seconds =
      1e-9 * fewest_pictures * static_cast<double>(tracks.cameras[slowest].rhythm().period().value_or(0));
  if (seconds <= dwell) return "hold it still";
  return formatted("hold it still for %.1f s: %s gives only %.1f pictures a second", seconds,
                   tracks.camera_names[slowest].c_str(), tracks.cameras[slowest].rhythm().rate());
}

/// The LiDAR that has not yet measured enough of the hold.
const std::string* late_lidar(const Tracks& tracks, const CaptureOptions& options, const Assessment& a,
                              std::int64_t now) {
  for (std::size_t i = 0; i < tracks.lidars.size(); ++i) {
    const LidarTrack& lidar = tracks.lidars[i];
    if (lidar.rhythm().silent(now)) continue;
    const double fit = 1e9 * options.dwell / static_cast<double>(lidar.period());
    const double needed = std::max(1.0, std::ceil(enough_scans * fit));
    if (static_cast<double>(lidar.within(a.since, a.newest).size()) < needed) return &tracks.lidar_names[i];
  }
  return nullptr;
}

/// Lets go of the oldest of all sensors first, so that all reach equally far back; never of what a sensor
/// needs for a view: the last dwell, of a slow camera the last pictures.
void keep_to_budget(Tracks& tracks, const CaptureOptions& options, std::size_t budget) {
  const auto dwell = static_cast<std::int64_t>(1e9 * options.dwell) + settling;
  std::size_t bytes = 0;
  for (CameraTrack& camera : tracks.cameras) bytes += camera.kept().bytes();
  for (LidarTrack& lidar : tracks.lidars) bytes += lidar.kept().bytes();
  while (bytes > budget) {
    std::function<std::size_t()> let_go;
    std::int64_t oldest = std::numeric_limits<std::int64_t>::max();
    const auto look = [&](auto& track, std::int64_t needed) {
      const auto* kept = track.kept().oldest();
      if (!kept || kept->time >= oldest || kept->time >= track.newest()->time - needed) return;
      oldest = kept->time;
      let_go = [&track] { return track.count_let_go(), track.kept().let_go_of_oldest(); };
    };
    for (CameraTrack& camera : tracks.cameras) {
      const std::int64_t period = camera.rhythm().period().value_or(0);
      look(camera, std::max(dwell, static_cast<std::int64_t>(fewest_pictures) * period));
    }
    for (LidarTrack& lidar : tracks.lidars) look(lidar, dwell);
    if (!let_go) return;
    bytes -= let_go();
  }
}

}  // namespace

std::string too_slow_text(const std::string& name, const CameraTrack& camera) {
  return formatted(
      "%s gives a picture only every %.1f s, which tells nobody whether the board is still: one a "
      "second is needed",
      name.c_str(), 1e-9 * static_cast<double>(camera.rhythm().period().value_or(0)));
}

void look_back_far_enough(Tracks& tracks, const CaptureOptions& options, std::int64_t now) {
  double seconds = options.patience * options.dwell + 0.5;
  for (const CameraTrack& camera : tracks.cameras) {
    if (camera.too_slow() || camera.rhythm().silent(now)) continue;
    seconds =
        std::max(seconds, 1e-9 * periods_kept * static_cast<double>(camera.rhythm().period().value_or(0)));
  }
  const auto history = static_cast<std::int64_t>(1e9 * seconds);
  for (CameraTrack& camera : tracks.cameras) camera.look_back(history);
  for (LidarTrack& lidar : tracks.lidars) lidar.look_back(history);
}

Assessment assess(const Tracks& tracks, const CaptureOptions& options, std::int64_t now) {
  Assessment a;
  a.since = std::numeric_limits<std::int64_t>::min();
  a.newest = std::numeric_limits<std::int64_t>::max();
  std::int64_t period = 0;
  std::size_t last = 0, slowest = 0;  // to come to rest, and by its rate
  bool seen = false;
  for (std::size_t c = 0; c < tracks.cameras.size(); ++c) {
    const CameraTrack& camera = tracks.cameras[c];
    a.cameras.push_back(camera.stillness(now, options.board_motion, options.dwell));
    if (!a.cameras.back()) continue;
    const CameraStillness& still = *a.cameras.back();
    seen = true;
    if (still.since > a.since) a.since = still.since, last = c;
    a.newest = std::min(a.newest, still.newest);
    const std::int64_t own = camera.rhythm().period().value_or(0);
    if (own > period) period = own, slowest = c;
  }
  if (!seen) {
    const std::string silent = silent_sensors(tracks, now), slow = slow_cameras(tracks, now);
    a.reason = !silent.empty() ? "no data from " + silent : !slow.empty() ? slow : "no camera sees the board";
    return a;
  }
  std::size_t pictures = fewest_pictures;
  for (std::size_t c = 0; c < tracks.cameras.size(); ++c) {
    if (a.cameras[c]) pictures = std::min(pictures, tracks.cameras[c].between(a.since, a.newest).size());
  }
  // A picture stands for the time until the next one.
  const double held = 1e-9 * static_cast<double>(a.newest - a.since + period);
  a.progress = std::clamp(held / options.dwell, 0.0,
                          static_cast<double>(pictures) / static_cast<double>(fewest_pictures));
  if (a.progress < 1) {
    const CameraStillness& still = *a.cameras[last];
    const bool moves = a.progress < stopped || pictures < 2;
    a.phase = moves ? Assessment::Phase::moving : Assessment::Phase::holding;
    a.reason = moves && still.motion > still.limit
                   ? formatted("the board moves %.1f px in %s; hold it still", still.motion,
                               tracks.camera_names[last].c_str())
                   : hold_it_still(tracks, slowest, options.dwell);
    return a;
  }
  const std::string* late = late_lidar(tracks, options, a, now);
  if (late && held < options.patience * options.dwell) {
    a.phase = Assessment::Phase::holding;
    a.reason = "waiting for scans of " + *late;
    return a;
  }
  a.phase = Assessment::Phase::ready;
  return a;
}

void release_unneeded(Tracks& tracks, const CaptureOptions& options, const Assessment& assessment,
                      std::optional<std::int64_t> decided, std::size_t budget) {
  const bool held =
      assessment.phase == Assessment::Phase::holding || assessment.phase == Assessment::Phase::ready;
  const auto oldest = [&](std::int64_t newest, std::int64_t lag) {
    if (decided) return std::min(*decided, newest - settling);
    if (assessment.phase == Assessment::Phase::absent) return newest - settling - lag;
    if (held) return std::min(assessment.since, newest) - settled;
    return std::min(assessment.since, newest) - settling - lag;
  };
  for (CameraTrack& camera : tracks.cameras) {
    if (camera.newest()) camera.release_before(oldest(camera.newest()->time, 0));
  }
  // A scan is there before the picture that tells of a hold in it has been searched; and a person who wants a
  // view at once gets whole revolutions.
  for (LidarTrack& lidar : tracks.lidars) {
    if (lidar.newest())
      lidar.release_before(oldest(lidar.newest()->time, 3 * lidar.period()) -
                           (decided ? 2 * lidar.period() : 0));
  }
  keep_to_budget(tracks, options, budget);
}

}  // namespace ca2
