#include "drivers/clock/device_clock.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace ca2 {
namespace {

/// Modulo 2^64 instead of overflowing: stamps of a damaged packet may be anything.
std::int64_t difference(std::int64_t a, std::int64_t b) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b));
}

std::int64_t sum(std::int64_t a, std::int64_t b) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(b));
}

struct PlanePoint {
  double x = 0, y = 0;  ///< device time and offset, ns from a common reference
};

/// The slope of the edge of the lower convex hull over the points' mean x: the slope of the line under all
/// points with the least sum of distances to them. Points are sorted by x, at least two different ones.
double envelope_slope(const std::vector<PlanePoint>& points) {
  std::vector<PlanePoint> hull;
  double mean = 0;
  for (const PlanePoint& p : points) {
    mean += p.x / static_cast<double>(points.size());
    const auto turns_up = [&] {
      const PlanePoint &a = hull[hull.size() - 2], &b = hull.back();
      return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x) > 0;
    };
    while (hull.size() >= 2 && !turns_up()) hull.pop_back();
    hull.push_back(p);
  }
  std::size_t right = 1;
  while (right + 1 < hull.size() && hull[right].x < mean) ++right;
  return (hull[right].y - hull[right - 1].y) / (hull[right].x - hull[right - 1].x);
}

}  // namespace

std::int64_t ClockMapping::to_host(std::int64_t device) const {
  const std::int64_t elapsed = difference(device, device_reference);
  const auto correction = static_cast<std::int64_t>(std::llround(static_cast<double>(elapsed) * drift));
  return sum(sum(host_reference, elapsed), correction);
}

double ClockMapping::sigma_ns(std::int64_t device) const {
  return std::hypot(sigma_at_reference,
                    sigma_drift * static_cast<double>(difference(device, device_reference)));
}

void DeviceClock::restart(const Point& point) {
  slots_.assign(1, point);
  newest_ = point.device;
  suspect_since_.reset();
  fit();
}

bool DeviceClock::jumped(const Point& point, std::int64_t host, Update& verdict) {
  const std::int64_t late = difference(host, mapping_->to_host(point.device));
  const std::int64_t silence = std::max<std::int64_t>(0, difference(point.device, newest_));
  const auto tolerance =
      options_.jump_tolerance + static_cast<std::int64_t>(options_.max_drift * static_cast<double>(silence));
  // Earlier than possible, or back in its own time by more than packets can be reordered: certain at once.
  if (late < -tolerance || difference(newest_, point.device) > options_.jump_tolerance) return true;
  if (late <= tolerance) {
    suspect_since_.reset();
    return false;
  }
  // Late packets may just have been held up: only if no packet is in time any more was the clock set back.
  if (!suspect_since_) suspect_since_ = host;
  verdict = Update::suspect;
  return difference(host, *suspect_since_) >= options_.jump_confirm;
}

DeviceClock::Update DeviceClock::update(std::int64_t device, std::int64_t host) {
  const Point point{device, difference(host, device)};
  if (!mapping_) {
    restart(point);
    return Update::first;
  }
  Update verdict = Update::regular;
  if (jumped(point, host, verdict)) {
    ++jumps_;
    restart(point);
    return Update::jump;
  }
  if (verdict == Update::suspect) return verdict;

  newest_ = std::max(newest_, device);
  const bool new_slot = difference(device, slots_.back().device) >= options_.slot;
  bool fit_due = new_slot;
  if (new_slot) {
    slots_.push_back(point);
  } else if (difference(slots_.back().device, device) <= options_.slot &&
             point.offset < slots_.back().offset) {
    // The slot keeps its place in time: the offset moves with the drift by far less than its jitter.
    slots_.back().offset = point.offset;
    fit_due = host < mapping_->to_host(device);
  }
  while (slots_.size() > 1 && difference(newest_, slots_.front().device) > options_.window)
    slots_.pop_front();
  if (fit_due) fit();
  return verdict;
}

void DeviceClock::fit() {
  // The newest slot may still be filling; it counts like the others, as its packets are real.
  const Point origin = slots_.front();
  std::vector<PlanePoint> points;
  for (const Point& slot : slots_) {
    points.push_back({static_cast<double>(difference(slot.device, origin.device)),
                      static_cast<double>(difference(slot.offset, origin.offset))});
  }
  const double n = static_cast<double>(points.size());
  const double span = points.back().x;
  // Below a quarter of the window the slope would be mostly jitter.
  const bool sloped = span * 4 >= static_cast<double>(options_.window);
  const double drift =
      sloped ? std::clamp(envelope_slope(points), -options_.max_drift, options_.max_drift) : 0;

  double intercept = std::numeric_limits<double>::infinity();
  for (const PlanePoint& p : points) intercept = std::min(intercept, p.y - drift * p.x);
  double excess = 0, mean = 0;
  for (const PlanePoint& p : points) {
    excess += (p.y - drift * p.x - intercept) / n;
    mean += p.x / n;
  }
  // With slot minima spread like an exponential of mean `excess`, the least of n lies excess/n above the
  // true floor; few slots say little about the spread, so the assumed jitter fades as they come.
  const double jitter = excess + options_.first_sigma / n;

  ClockMapping mapping;
  const auto reference = static_cast<std::int64_t>(mean);
  mapping.device_reference = sum(origin.device, reference);
  const auto offset =
      static_cast<std::int64_t>(std::llround(intercept + drift * static_cast<double>(reference)));
  mapping.host_reference = sum(sum(mapping.device_reference, origin.offset), offset);
  mapping.drift = drift;
  mapping.sigma_at_reference = std::hypot(options_.fixed_sigma, 2 * jitter / n);
  // Two slots about half the span apart carry the line.
  mapping.sigma_drift = sloped ? 4 * jitter / n / (span / 2) : options_.max_drift / 2;
  mapping_ = mapping;
}

}  // namespace ca2
