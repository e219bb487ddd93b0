#include "core/lidar/ring_runs.h"

#include <algorithm>
#include <cmath>

namespace ca2 {
namespace {

constexpr int kBridge = 2;  // missing returns that do not end a run: drop-outs, black print

/// One ring: where its runs end, and which of them the board could be.
class RingWalk {
 public:
  RingWalk(const RingImage& image, int row, const RunLimits& limits)
      : range_(&image.range[image.index(row, 0)]), columns_(image.columns), row_(row), jump_(limits.jump) {
    const float slope = image.slope[static_cast<std::size_t>(row)];
    angle_ = image.column_angle / std::sqrt(1 + slope * slope);
    steep_ = kSteep * angle_;
    least_ = limits.shortest * limits.shortest;
    most_ = limits.longest * limits.longest;
  }

  void add_runs(std::vector<RingRun>& runs) const {
    const int begin = first_end();
    if (begin < 0) return;  // one surface all round
    int first = begin, last = begin;
    float last_range = range_[begin];
    const auto walk = [&](int from, int to, int turn) {
      for (int column = from; column < to; ++column) {
        const float r = range_[column];
        if (r == 0) continue;
        const int place = column + turn;
        if (parted(last_range, r) || place - last > kBridge + 1) {
          add(first, last, runs);
          first = place;
        }
        last = place;
        last_range = r;
      }
    };
    walk(begin + 1, columns_, 0);
    walk(0, begin, columns_);
    add(first, last, runs);
  }

 private:
  int wrap(int column) const { return column < columns_ ? column : column - columns_; }
  bool parted(float a, float b) const { return std::abs(a - b) > std::max(jump_, steep_ * std::min(a, b)); }

  /// A return that the one before it is parted from: a walk may begin there.
  /// -1: none.
  int first_end() const {
    int last = -1;
    for (int column = 0; column < columns_; ++column) {
      if (range_[column] == 0) continue;
      if (last >= 0 && (column - last > kBridge + 1 || parted(range_[last], range_[column]))) return column;
      last = column;
    }
    return -1;
  }

  void add(int first, int last, std::vector<RingRun>& runs) const {
    if (last - first < 2) return;
    const float a = range_[wrap(first)], b = range_[wrap(last)];
    const float across = static_cast<float>(last - first) * angle_;
    const float chord = (a - b) * (a - b) + a * b * across * across;
    if (chord >= least_ && chord <= most_) runs.push_back({row_, first, last});
  }

  const float* range_;
  int columns_, row_;
  float jump_, angle_, steep_, least_, most_;
};

}  // namespace

void find_ring_runs(const RingImage& image, const RunLimits& limits, std::vector<RingRun>& runs) {
  runs.clear();
  for (int row = 0; row < image.rows; ++row) RingWalk(image, row, limits).add_runs(runs);
}

}  // namespace ca2
