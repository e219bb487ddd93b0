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

/// Mean over the corners of both.
double distance(const CornerPixels& a, const CornerPixels& b) {
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
  explicit Spread(const CornerPixels& first) : low_(first), high_(first) {}

  double with(const CornerPixels& pixels) {
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
  CornerPixels low_, high_;
};

}  // namespace

CameraTrack::CameraTrack(const Board& board)
    : places_(board.type->corners(board)), half_turn_ambiguous_(board.type->half_turn_ambiguous(board)) {}

void CameraTrack::add(const CameraObservation& observation) {
  ++frames_;
  rhythm_.add(observation.time);
  if (!observation.searched) {
    shed_ += observation.spared ? 0 : 1;
    return;
  }
  if (!samples_.empty() && observation.time <= samples_.back().time) {  // the clock was set
    samples_.clear();
    pixels_.clear();
  }
  // Counted by the clock, so that cameras that are triggered together keep the same ones.
  if (!samples_.empty() && samples_.back().time / picture_spacing == observation.time / picture_spacing)
    samples_.back().image.reset();
  samples_.push_back(observation);
  CornerPixels pixels = by_id(observation.corners);
  if (half_turn_ambiguous_) label_as_before(samples_.back().corners, pixels);
  pixels_.push_back(std::move(pixels));
  // What shows no board is in no view: its pixels need not be kept.
  if (observation.corners.empty()) samples_.back().image.reset();
  while (samples_.front().time < observation.time - history_) {
    samples_.pop_front();
    pixels_.pop_front();
  }
}

CornerPixels CameraTrack::by_id(const std::vector<Corner>& corners) const {
  CornerPixels pixels(places_.size());
  for (const Corner& corner : corners) {
    if (corner.id >= 0 && static_cast<std::size_t>(corner.id) < pixels.size())
      pixels[static_cast<std::size_t>(corner.id)] = corner.pixel;
  }
  return pixels;
}

/// Of the two labellings that are half a turn apart the one that agrees with the last picture of the board.
void CameraTrack::label_as_before(std::vector<Corner>& corners, CornerPixels& pixels) const {
  for (std::size_t k = pixels_.size(); k-- > 0;) {
    if (samples_[k].corners.empty()) continue;
    CornerPixels turned(pixels.rbegin(), pixels.rend());
    if (distance(turned, pixels_[k]) < distance(pixels, pixels_[k])) {
      pixels = std::move(turned);
      for (Corner& corner : corners) corner.id = static_cast<int>(places_.size()) - 1 - corner.id;
    }
    return;
  }
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

double CameraTrack::pixels_per_metre(const std::vector<Corner>& corners) const {
  double pixels = 0, metres = 0;
  for (const Corner& a : corners) {
    const Corner& b = corners.front();
    pixels += (a.pixel - b.pixel).norm();
    metres += (places_[static_cast<std::size_t>(a.id)] - places_[static_cast<std::size_t>(b.id)]).norm();
  }
  return metres > 0 ? pixels / metres : 0;
}

std::optional<CameraStillness> CameraTrack::stillness(std::int64_t now, double board_motion,
                                                      double dwell) const {
  if (samples_.empty() || rhythm_.silent(now) || too_slow()) return std::nullopt;
  const std::int64_t gap = longest_gap();
  std::size_t at = samples_.size() - 1;
  while (at > 0 && samples_[at].corners.empty()) --at;
  if (samples_[at].corners.empty() || samples_.back().time - samples_[at].time > gap) return std::nullopt;
  CameraStillness still;
  still.newest = still.since = samples_[at].time;
  still.limit = std::max(least_motion, board_motion * pixels_per_metre(samples_[at].corners));
  Spread spread(pixels_[at]);
  const auto window = std::max(static_cast<std::int64_t>(1e9 * dwell), gap);
  bool is_still = true;
  for (std::int64_t last = samples_[at].time; at-- > 0;) {
    const CameraObservation& sample = samples_[at];
    if (sample.corners.empty()) continue;
    if (last - sample.time > gap) break;
    last = sample.time;
    const double motion = spread.with(pixels_[at]);
    if (still.newest - sample.time <= window) still.motion = motion;
    is_still = is_still && motion <= still.limit;
    if (is_still) still.since = sample.time;
    if (!is_still && still.newest - sample.time > window) break;
  }
  still.since = settled(still);
  return still;
}

/// Hands come to rest slowly: the hold begins where the corners are within half the limit of where they are
/// in its second half.
std::int64_t CameraTrack::settled(const CameraStillness& still) const {
  const auto of_hold = [&](const CameraObservation& sample) {
    return !sample.corners.empty() && sample.time >= still.since && sample.time <= still.newest;
  };
  CornerPixels mean(places_.size());
  std::vector<double> count(places_.size(), 0);
  for (std::size_t k = samples_.size(); k-- > 0;) {
    if (samples_[k].time < still.newest - (still.newest - still.since) / 2) break;
    if (!of_hold(samples_[k])) continue;
    const CornerPixels& pixels = pixels_[k];
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
  for (std::size_t k = 0; k < samples_.size(); ++k) {
    if (of_hold(samples_[k]) && distance(pixels_[k], mean) <= limit) return samples_[k].time;
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
  std::vector<Eigen::Vector2d> sum(places_.size(), Eigen::Vector2d::Zero());
  std::vector<std::size_t> count(places_.size(), 0);
  for (const CameraObservation* picture : pictures) {
    const CornerPixels pixels = by_id(picture->corners);
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
