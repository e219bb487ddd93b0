#include "core/lidar/rectangle_fit.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>
#include <vector>

namespace ca2 {
namespace {

/// Best position of a window of a given width over weighted places on a line,
/// by sums over bins.
class SlidingWindow {
 public:
  SlidingWindow(float width, float reach, int bins_per_width)
      : bin_(width / static_cast<float>(bins_per_width)),
        bins_per_m_(1 / bin_),
        window_(bins_per_width),
        reach_(1.0001f * std::max(reach, width)),
        bins_(static_cast<std::size_t>(2 * reach_ * bins_per_m_) + 2) {}

  void clear() { std::fill(bins_.begin(), bins_.end(), 0.0f); }
  /// Only of places within the reach.
  int bin(float place) const { return static_cast<int>((place + reach_) * bins_per_m_); }
  void add(int bin, float weight) { bins_[static_cast<std::size_t>(bin)] += weight; }
  /// Centre of the best window, the middle of the stretch of equally good ones;
  /// its weight.
  std::pair<float, float> best() const {
    const int last = static_cast<int>(bins_.size()) - window_;
    float sum = 0;
    for (int i = 0; i < window_; ++i) sum += bins_[static_cast<std::size_t>(i)];
    float top = sum;
    int from = 0, to = 0;
    for (int i = 1; i <= last; ++i) {
      sum += bins_[static_cast<std::size_t>(i + window_ - 1)] - bins_[static_cast<std::size_t>(i - 1)];
      if (sum > top + 1e-3f)
        top = sum, from = to = i;
      else if (sum > top - 1e-3f && to == i - 1)
        to = i;
    }
    return {(static_cast<float>(from + to) / 2 + static_cast<float>(window_) / 2) * bin_ - reach_, top};
  }

 private:
  float bin_, bins_per_m_;
  int window_;
  float reach_;
  std::vector<float> bins_;
};

class Search {
 public:
  Search(std::span<const PlaneSample> samples, double width, double height, int bins)
      : samples_(samples), width_(static_cast<float>(width)), height_(static_cast<float>(height)) {
    for (const PlaneSample& s : samples) reach_ = std::max(reach_, std::hypot(s.u, s.v));
    along_ = SlidingWindow(width_, reach_, bins);
    across_ = SlidingWindow(height_, reach_, bins);
    x_.resize(samples.size());
    y_.resize(samples.size());
    x_bin_.resize(samples.size());
    y_bin_.resize(samples.size());
  }

  /// Best centre at one angle: windows along both sides in turn, each over what
  /// lies in the other.
  PlaneRectangle at(double angle, double u, double v) {
    const auto c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      x_[i] = c * samples_[i].u + s * samples_[i].v;
      y_[i] = c * samples_[i].v - s * samples_[i].u;
      x_bin_[i] = along_.bin(x_[i]);
      y_bin_[i] = across_.bin(y_[i]);
    }
    float x = static_cast<float>(c * u + s * v), y = static_cast<float>(c * v - s * u), weight = 0;
    for (int round = 0; round < 3; ++round) {
      const float last_x = x, last_y = y;
      x = slide(along_, x_bin_, y_, y, height_).first;
      // The same stretch gives the same place across it.
      if (round > 0 && x == last_x) break;
      std::tie(y, weight) = slide(across_, y_bin_, x_, x, width_);
      if (y == last_y) break;
    }
    return {c * x - s * y, s * x + c * y, angle, weight};
  }

 private:
  std::pair<float, float> slide(SlidingWindow& window, const std::vector<int>& bins,
                                const std::vector<float>& other, float centre, float side) const {
    window.clear();
    // Without a branch: which samples lie within is nothing that a processor
    // could guess.
    const float half = side / 2;
    for (std::size_t i = 0; i < bins.size(); ++i) {
      window.add(bins[i], std::abs(other[i] - centre) < half ? samples_[i].weight : 0.0f);
    }
    return window.best();
  }

  std::span<const PlaneSample> samples_;
  float width_, height_, reach_ = 0;
  SlidingWindow along_{1, 1, 2}, across_{1, 1, 2};
  std::vector<float> x_, y_;
  std::vector<int> x_bin_, y_bin_;
};

}  // namespace

void PlaneRectangle::local(double pu, double pv, double& x, double& y) const {
  const double c = std::cos(angle), s = std::sin(angle);
  x = c * (pu - u) + s * (pv - v);
  y = c * (pv - v) - s * (pu - u);
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
  best.angle = std::fmod(best.angle + std::numbers::pi, std::numbers::pi);
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
  best.weight = -1e30;
  for (int i = 0; i < 12; ++i) {
    const PlaneRectangle r = coarse.at(i * kStep, u, v);
    if (r.weight > best.weight) best = r;
  }
  best = refined(fine, fine.at(best.angle, best.u, best.v), kStep / 2);
  return best;
}

}  // namespace ca2
