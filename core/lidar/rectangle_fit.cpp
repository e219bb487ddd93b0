#include "core/lidar/rectangle_fit.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <tuple>
#include <vector>

#include "core/types/hot_loop.h"

namespace ca2 {
namespace {

/// The weights of all windows over bins, by the bin they begin at, and the first of the heaviest. Step by
/// step, so that all but the running sum goes eight at a time.
CA2_HOT_LOOP std::size_t heaviest_window(const std::int32_t* __restrict bins, std::size_t window,
                                         std::size_t windows, std::int32_t* __restrict sums) {
  std::int32_t sum = 0;
  for (std::size_t i = 0; i < window; ++i) sum += bins[i];
  sums[0] = sum;
  for (std::size_t i = 1; i < windows; ++i) sums[i] = bins[i + window - 1] - bins[i - 1];
  for (std::size_t i = 1; i < windows; ++i) sums[i] = sum += sums[i];
  std::int32_t top = sums[0];
  for (std::size_t i = 1; i < windows; ++i) top = sums[i] > top ? sums[i] : top;
  const auto count = static_cast<std::int32_t>(windows);
  std::int32_t first = count;
  for (std::int32_t i = 0; i < count; ++i) {
    const std::int32_t here = sums[i] == top ? i : count;
    first = here < first ? here : first;
  }
  return static_cast<std::size_t>(first);
}

/// Best position of a window of a given width over weighted places on a line,
/// by sums over bins.
class SlidingWindow {
 public:
  SlidingWindow(float width, float reach, int bins_per_width)
      : bin_(width / static_cast<float>(bins_per_width)),
        bins_per_m_(1 / bin_),
        window_(static_cast<std::size_t>(bins_per_width)),
        reach_(1.0001f * std::max(reach, width)),
        bins_(static_cast<std::size_t>(2 * reach_ * bins_per_m_) + 2),
        sums_(bins_.size() - window_ + 1) {}

  /// The bin of a place within the reach is (place + reach) * bins_per_m.
  float reach() const { return reach_; }
  float bins_per_m() const { return bins_per_m_; }

  /// Weights, and the bins they are in.
  void fill(const std::vector<std::int32_t>& bins, const std::vector<std::int32_t>& weights) {
    std::fill(bins_.begin(), bins_.end(), 0);
    std::int32_t* const sums = bins_.data();
#pragma GCC unroll 4
    for (std::size_t i = 0; i < bins.size(); ++i) sums[bins[i]] += weights[i];
  }
  /// Centre of the best window, the middle of the stretch of equally good ones;
  /// its weight.
  std::pair<float, std::int32_t> best() {
    const std::size_t from = heaviest_window(bins_.data(), window_, sums_.size(), sums_.data());
    const std::int32_t top = sums_[from];
    std::size_t last = from;
    while (last + 1 < sums_.size() && sums_[last + 1] == top) ++last;
    const auto middles = static_cast<float>(from + last);
    return {(middles / 2 + static_cast<float>(window_) / 2) * bin_ - reach_, top};
  }

 private:
  float bin_, bins_per_m_;
  std::size_t window_;
  float reach_;
  std::vector<std::int32_t> bins_, sums_;  ///< sums_: of the windows that begin at each bin
};

/// x = c u + s v and its bin.
struct Axis {
  float c, s, reach, bins_per_m;
};
CA2_HOT_LOOP void turn_samples(const Axis& axis, std::size_t size, const float* __restrict u,
                               const float* __restrict v, float* __restrict x, std::int32_t* __restrict bin) {
  const Axis a = axis;
  for (std::size_t i = 0; i < size; ++i) {
    x[i] = a.c * u[i] + a.s * v[i];
    bin[i] = static_cast<std::int32_t>((x[i] + a.reach) * a.bins_per_m);
  }
}

/// The weights of those within half a side of the centre, 0 for the others: which they are is nothing that a
/// processor could guess.
CA2_HOT_LOOP void weigh_within(float centre, float half, std::size_t size, const float* __restrict place,
                               const std::int32_t* __restrict weight, std::int32_t* __restrict out) {
  for (std::size_t i = 0; i < size; ++i) out[i] = std::abs(place[i] - centre) < half ? weight[i] : 0;
}

class Search {
 public:
  Search(std::span<const PlaneSample> samples, double width, double height, int bins)
      : width_(static_cast<float>(width)), height_(static_cast<float>(height)) {
    float reach = 0;
    for (const PlaneSample& s : samples) {
      reach = std::max(reach, std::hypot(s.u, s.v));
      u_.push_back(s.u);
      v_.push_back(s.v);
      weight_.push_back(s.weight);
    }
    along_ = SlidingWindow(width_, reach, bins);
    across_ = SlidingWindow(height_, reach, bins);
    for (std::vector<float>* list : {&x_, &y_}) list->resize(samples.size());
    for (std::vector<std::int32_t>* list : {&x_bin_, &y_bin_, &within_}) list->resize(samples.size());
  }

  /// Best centre at one angle: windows along both sides in turn, each over what
  /// lies in the other.
  PlaneRectangle at(double angle, double u, double v) {
    const auto c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
    turn_samples({c, s, along_.reach(), along_.bins_per_m()}, u_.size(), u_.data(), v_.data(), x_.data(),
                 x_bin_.data());
    turn_samples({c, -s, across_.reach(), across_.bins_per_m()}, u_.size(), v_.data(), u_.data(), y_.data(),
                 y_bin_.data());
    float x = static_cast<float>(c * u + s * v), y = static_cast<float>(c * v - s * u);
    std::int32_t weight = 0;
    for (int round = 0; round < 3; ++round) {
      const float last_x = x, last_y = y;
      x = slide(along_, x_bin_, y_, y, height_).first;
      // The same stretch gives the same place across it.
      if (round > 0 && x == last_x) break;
      std::tie(y, weight) = slide(across_, y_bin_, x_, x, width_);
      if (y == last_y) break;
    }
    PlaneRectangle out{c * x - s * y, s * x + c * y};
    out.turn(angle);
    out.weight = weight;
    return out;
  }

 private:
  std::pair<float, std::int32_t> slide(SlidingWindow& window, const std::vector<std::int32_t>& bins,
                                       const std::vector<float>& other, float centre, float side) {
    weigh_within(centre, side / 2, other.size(), other.data(), weight_.data(), within_.data());
    window.fill(bins, within_);
    return window.best();
  }

  float width_, height_;
  SlidingWindow along_{1, 1, 2}, across_{1, 1, 2};
  std::vector<float> u_, v_;
  std::vector<std::int32_t> weight_;
  // At the angle that is looked at.
  std::vector<float> x_, y_;
  std::vector<std::int32_t> x_bin_, y_bin_, within_;
};

}  // namespace

void PlaneRectangle::turn(double to) {
  angle = to;
  cosine = std::cos(to);
  sine = std::sin(to);
}

namespace {

constexpr double kStep = std::numbers::pi / 12;

/// Every few samples, so that there are at most `most`.
std::vector<PlaneSample> thinned(std::span<const PlaneSample> samples, std::size_t most) {
  std::vector<PlaneSample> part;
  const std::size_t step = std::max<std::size_t>(1, (samples.size() + most - 1) / most);
  part.reserve(samples.size() / step + 1);
  for (std::size_t i = 0; i < samples.size(); i += step) part.push_back(samples[i]);
  return part;
}

/// Better angles by ever smaller steps to both sides.
PlaneRectangle refined(Search& search, PlaneRectangle best, double step) {
  for (; step > 0.015; step /= 2) {
    for (const double angle : {best.angle - step, best.angle + step}) {
      const PlaneRectangle r = search.at(angle, best.u, best.v);
      if (r.weight > best.weight) best = r;
    }
  }
  best.turn(std::fmod(best.angle + std::numbers::pi, std::numbers::pi));
  return best;
}

}  // namespace

PlaneRectangle fit_rectangle(std::span<const PlaneSample> samples, double width, double height) {
  double u = 0, v = 0, on = 0;
  for (const PlaneSample& s : samples) {
    if (s.weight > 0) u += s.u, v += s.v, on += 1;
  }
  u /= std::max(on, 1.0), v /= std::max(on, 1.0);
  // Coarse over all angles on a part of the samples, then finer steps on more
  // of them; the place on all.
  constexpr std::size_t kCoarse = 400, kFine = 1000;
  const std::vector<PlaneSample> few = thinned(samples, kCoarse), many = thinned(samples, kFine);
  Search coarse(few, width, height, 32), fine(many, width, height, 64);
  PlaneRectangle best;
  best.weight = std::numeric_limits<std::int32_t>::min();
  for (int i = 0; i < 12; ++i) {
    const PlaneRectangle r = coarse.at(i * kStep, u, v);
    if (r.weight > best.weight) best = r;
  }
  best = refined(fine, fine.at(best.angle, best.u, best.v), kStep / 2);
  return best;
}

}  // namespace ca2
