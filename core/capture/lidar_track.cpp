#include "core/capture/lidar_track.h"

#include <algorithm>
#include <cmath>

namespace ca2 {
namespace {

// The sensors' clocks may disagree by so much: a scan that begins so much early still is of the hold.
constexpr std::int64_t clock_slack = 15'000'000;  // ns
// Between two scans the same patch is found so close. Where rings lie far apart its centre jumps by half
// their distance.
constexpr double same_place = 0.12;   // m
constexpr double same_normal = 0.94;  // cosine

}  // namespace

double plane_motion(const LidarSight& a, const LidarSight& b) {
  return std::max(std::abs(a.plane.distance(b.center)), std::abs(b.plane.distance(a.center)));
}

void LidarTrack::add(const LidarObservation& observation) {
  ++frames_;
  rhythm_.add(observation.time);
  if (!observation.searched) {
    ++shed_;
    return;
  }
  if (!samples_.empty() && observation.time <= samples_.back().time) samples_.clear();  // the clock was set
  // What shows no board is in no view: only the newest scan is asked for beside that.
  if (!samples_.empty() && samples_.back().sights.empty()) samples_.back().scan.reset();
  samples_.push_back(observation);
  while (samples_.front().time < observation.time - history_) samples_.pop_front();
}

void LidarTrack::release_before(std::int64_t time) {
  for (LidarObservation& sample : samples_) {
    if (begins_since(time, sample) || &sample == &samples_.back()) break;
    sample.scan.reset();
  }
}

bool LidarTrack::begins_since(std::int64_t time, const LidarObservation& sample) const {
  return sample.time - period() / 2 >= time - clock_slack;
}

std::vector<const LidarObservation*> LidarTrack::within(std::int64_t first, std::int64_t last) const {
  std::vector<const LidarObservation*> list;
  const std::int64_t half = period() / 2;
  for (const LidarObservation& sample : samples_) {
    if (begins_since(first, sample) && sample.time + half <= last + clock_slack) list.push_back(&sample);
  }
  return list;
}

std::vector<LidarHold> LidarTrack::follow(const std::vector<const LidarObservation*>& scans) {
  std::vector<LidarHold> holds;
  if (scans.empty()) return holds;
  const LidarObservation& newest = *scans.back();
  for (std::size_t i = 0; i < newest.sights.size(); ++i) {
    LidarHold hold;
    hold.sight = i;
    const LidarSight& reference = newest.sights[i];
    double novelty = 0, found = 0;
    for (const LidarObservation* scan : scans) {
      const LidarSight* nearest = nullptr;
      std::size_t index = 0;
      for (std::size_t k = 0; k < scan->sights.size(); ++k) {
        const LidarSight& sight = scan->sights[k];
        if ((sight.center - reference.center).norm() > same_place ||
            sight.plane.normal.dot(reference.plane.normal) < same_normal)
          continue;
        if (nearest && (sight.center - reference.center).norm() > (nearest->center - reference.center).norm())
          continue;
        nearest = &sight;
        index = k;
      }
      if (!nearest) continue;
      ++found;
      hold.motion = std::max(hold.motion, plane_motion(*nearest, reference));
      novelty += index < scan->novelty.size() ? scan->novelty[index] : std::nan("");
    }
    hold.presence = found / static_cast<double>(scans.size());
    hold.novelty = novelty / found;
    holds.push_back(hold);
  }
  return holds;
}

}  // namespace ca2
