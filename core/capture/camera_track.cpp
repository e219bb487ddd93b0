#include "core/capture/camera_track.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ca2 {
namespace {

// A picture without the board between others (a detector's miss, a hand) does not end a hold. Slow cameras'
// pictures are farther apart than that.
constexpr std::int64_t shortest_gap = 300'000'000;  // ns
constexpr std::int64_t gap_halves = 3;              // half periods
// Slower ones are of no use: people cannot stand still for so long.
constexpr std::int64_t longest_period = 1'250'000'000;  // ns
// Detectors' errors alone move corners by so much.
constexpr double least_motion = 0.5;  // px
// So many pictures per second make the mean as good as it gets; a fast camera's others only fill the memory.
constexpr std::int64_t picture_spacing = 62'500'000;  // ns

using Pixels = std::vector<std::optional<Eigen::Vector2d>>;

double distance(const Pixels& a, const Pixels& b) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i] && b[i]) sum += (*a[i] - *b[i]).norm(), ++count;
  }
  return count > 0 ? sum / count : std::numeric_limits<double>::infinity();
}

/// By how much corners have moved about: of every corner the larger side of the box it kept to, and of these
/// the upper quartile, so that a corner or two that were misplaced do not count.
class Spread {
 public:
  explicit Spread(const Pixels& first) : low_(first), high_(first) {}

  double with(const Pixels& pixels) {
    std::vector<double> sides;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      if (!pixels[i]) continue;
      low_[i] = low_[i] ? Eigen::Vector2d(low_[i]->cwiseMin(*pixels[i])) : *pixels[i];
      high_[i] = high_[i] ? Eigen::Vector2d(high_[i]->cwiseMax(*pixels[i])) : *pixels[i];
      sides.push_back((*high_[i] - *low_[i]).maxCoeff());
    }
    if (sides.empty()) return std::numeric_limits<double>::infinity();
    const auto quartile = sides.begin() + static_cast<std::ptrdiff_t>(3 * sides.size() / 4);
    std::nth_element(sides.begin(), quartile, sides.end());
    return *quartile;
  }

 private:
  Pixels low_, high_;
};

}  // namespace

void CameraTrack::add(const CameraObservation& observation) {
  ++frames_;
  rhythm_.add(observation.time);
  if (!observation.searched) {
    ++shed_;
    return;
  }
  if (!samples_.empty() && observation.time <= samples_.back().time) samples_.clear();  // the clock was set
  // Counted by the clock, so that cameras that are triggered together keep the same ones.
  if (!samples_.empty() && samples_.back().time / picture_spacing == observation.time / picture_spacing)
    samples_.back().image.reset();
  samples_.push_back(observation);
  // What shows no board is in no view: its pixels need not be kept.
  if (observation.corners.empty()) samples_.back().image.reset();
  while (samples_.front().time < observation.time - history_) samples_.pop_front();
}

bool CameraTrack::too_slow() const {
  return rhythm_.period().value_or(0) > longest_period;
}

std::int64_t CameraTrack::longest_gap() const {
  return std::max(shortest_gap, gap_halves * rhythm_.period().value_or(0) / 2);
}

void CameraTrack::release_before(std::int64_t time) {
  for (CameraObservation& sample : samples_) {
    if (sample.time >= time) break;
    sample.image.reset();
  }
}

Pixels CameraTrack::aligned(const std::vector<Corner>& corners, const Pixels& reference) const {
  const std::size_t all = board_.type->corners(board_).size();
  Pixels same(all);
  for (const Corner& corner : corners) {
    if (corner.id >= 0 && static_cast<std::size_t>(corner.id) < all)
      same[static_cast<std::size_t>(corner.id)] = corner.pixel;
  }
  if (reference.empty() || !board_.type->half_turn_ambiguous(board_)) return same;
  Pixels turned(same.rbegin(), same.rend());
  return distance(turned, reference) < distance(same, reference) ? turned : same;
}

double CameraTrack::pixels_per_metre(const std::vector<Corner>& corners) const {
  const std::vector<Eigen::Vector2d> places = board_.type->corners(board_);
  double pixels = 0, metres = 0;
  for (const Corner& a : corners) {
    const Corner& b = corners.front();
    pixels += (a.pixel - b.pixel).norm();
    metres += (places[static_cast<std::size_t>(a.id)] - places[static_cast<std::size_t>(b.id)]).norm();
  }
  return metres > 0 ? pixels / metres : 0;
}

std::optional<CameraStillness> CameraTrack::stillness(std::int64_t now, double board_motion,
                                                      double dwell) const {
  if (samples_.empty() || rhythm_.silent(now) || too_slow()) return std::nullopt;
  const std::int64_t gap = longest_gap();
  auto at = samples_.rbegin();
  while (at != samples_.rend() && at->corners.empty()) ++at;
  if (at == samples_.rend() || samples_.back().time - at->time > gap) return std::nullopt;
  CameraStillness still;
  still.newest = still.since = at->time;
  still.limit = std::max(least_motion, board_motion * pixels_per_metre(at->corners));
  const Pixels newest = aligned(at->corners, {});
  Spread spread(newest);
  const auto window = std::max(static_cast<std::int64_t>(1e9 * dwell), gap);
  bool is_still = true;
  for (std::int64_t last = at->time; ++at != samples_.rend();) {
    if (at->corners.empty()) continue;
    if (last - at->time > gap) break;
    last = at->time;
    const double motion = spread.with(aligned(at->corners, newest));
    if (still.newest - at->time <= window) still.motion = motion;
    is_still = is_still && motion <= still.limit;
    if (is_still) still.since = at->time;
    if (!is_still && still.newest - at->time > window) break;
  }
  still.since = settled(still, newest);
  return still;
}

/// Hands come to rest slowly: the hold begins where the corners are within half the limit of where they are
/// in its second half.
std::int64_t CameraTrack::settled(const CameraStillness& still, const Pixels& newest) const {
  const std::vector<const CameraObservation*> pictures = between(still.since, still.newest);
  Pixels mean(newest.size());
  std::vector<double> count(newest.size(), 0);
  std::vector<Pixels> aligned_pictures;
  for (const CameraObservation* picture : pictures) {
    const Pixels& pixels = aligned_pictures.emplace_back(aligned(picture->corners, newest));
    if (picture->time < still.newest - (still.newest - still.since) / 2) continue;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      if (!pixels[i]) continue;
      mean[i] = mean[i].value_or(Eigen::Vector2d::Zero()) + *pixels[i];
      ++count[i];
    }
  }
  for (std::size_t i = 0; i < mean.size(); ++i) {
    if (mean[i]) *mean[i] /= count[i];
  }
  const double limit = std::max(least_motion, still.limit / 2);
  for (std::size_t k = 0; k < pictures.size(); ++k) {
    if (distance(aligned_pictures[k], mean) <= limit) return pictures[k]->time;
  }
  return still.newest;
}

std::vector<const CameraObservation*> CameraTrack::between(std::int64_t first, std::int64_t last) const {
  std::vector<const CameraObservation*> list;
  for (const CameraObservation& sample : samples_) {
    if (!sample.corners.empty() && sample.time >= first && sample.time <= last) list.push_back(&sample);
  }
  return list;
}

std::vector<Corner> CameraTrack::mean_corners(const std::vector<const CameraObservation*>& pictures) const {
  if (pictures.empty()) return {};
  const Pixels newest = aligned(pictures.back()->corners, {});
  std::vector<Eigen::Vector2d> sum(newest.size(), Eigen::Vector2d::Zero());
  std::vector<std::size_t> count(newest.size(), 0);
  for (const CameraObservation* picture : pictures) {
    const Pixels pixels = aligned(picture->corners, newest);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      if (pixels[i]) sum[i] += *pixels[i], ++count[i];
    }
  }
  std::vector<Corner> corners;
  for (const Corner& corner : pictures.back()->corners) {
    const auto i = static_cast<std::size_t>(corner.id);
    if (i >= count.size() || 2 * count[i] < pictures.size()) continue;
    const auto n = static_cast<double>(count[i]);
    corners.push_back({corner.id, sum[i] / n, corner.covariance / n});
  }
  return corners;
}

}  // namespace ca2
