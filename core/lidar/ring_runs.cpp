#include "core/lidar/ring_runs.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/types/hot_loop.h"

namespace ca2 {
namespace {

constexpr int kBridge = 2;  // missing returns that do not end a run: drop-outs, black print

/// Where neighbouring returns are parted, or one of them is missing: few places of a ring, so that what they
/// have to say is asked only there. [column] of the second one.
CA2_HOT_LOOP void mark_breaks(const float* __restrict range, int columns, float jump, float steep,
                              std::uint8_t* __restrict out) {
  for (int i = 1; i < columns; ++i) {
    const float a = range[i - 1], b = range[i];
    const float least = a < b ? a : b, limit = steep * least > jump ? steep * least : jump;
    out[i] = std::abs(a - b) > limit || least == 0;
  }
}

/// One ring: where its runs end, and which of them the board could be.
class RingWalk {
 public:
  /// `breaks`: memory.
  RingWalk(const RingImage& image, int row, const RunLimits& limits, std::vector<std::uint8_t>& breaks)
      : range_(&image.range[image.index(row, 0)]), columns_(image.columns), row_(row), jump_(limits.jump) {
    const float slope = image.slope[static_cast<std::size_t>(row)];
    angle_ = image.column_angle / std::sqrt(1 + slope * slope);
    steep_ = kSteep * angle_;
    least_ = limits.shortest * limits.shortest;
    most_ = limits.longest * limits.longest;
    breaks.resize(static_cast<std::size_t>(columns_));
    breaks_ = breaks.data();
    mark_breaks(range_, columns_, jump_, steep_, breaks.data());
  }

  void add_runs(std::vector<RingRun>& runs) const {
    const int begin = first_end();
    if (begin < 0) return;  // one surface all round
    int first = begin, last = begin;
    float last_range = range_[begin];
    const auto walk = [&](int from, int to, int turn) {
      for (int column = from; column < to; ++column) {
        if (range_[column] == 0) continue;
        const int place = column + turn;
        if (parted(last_range, range_[column]) || place - last > kBridge + 1) {
          add(first, last, runs);
          first = place;
        }
        // On to the last one before a break.
        column = next_break(column + 1, to) - 1;
        last = column + turn;
        last_range = range_[column];
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
    int first = -1, last = -1;
    for (int column = 0; column < columns_; ++column) {
      if (range_[column] == 0) continue;
      if (last >= 0 && (column - last > kBridge + 1 || parted(range_[last], range_[column]))) return column;
      if (first < 0) first = column;
      last = column = next_break(column + 1, columns_) - 1;
    }
    // Nothing else came back in this ring, or the one surface ends where columns begin anew.
    const bool ends =
        first >= 0 && (first + columns_ - last > kBridge + 1 || parted(range_[last], range_[first]));
    return ends ? first : -1;
  }

  /// From this column on; `to` where there is none before it.
  int next_break(int from, int to) const {
    if (from >= to) return to;
    const void* const at = std::memchr(breaks_ + from, 1, static_cast<std::size_t>(to - from));
    return at ? static_cast<int>(static_cast<const std::uint8_t*>(at) - breaks_) : to;
  }

  void add(int first, int last, std::vector<RingRun>& runs) const {
    if (last - first < 2) return;
    const float a = range_[wrap(first)], b = range_[wrap(last)];
    const float across = static_cast<float>(last - first) * angle_;
    const float chord = (a - b) * (a - b) + a * b * across * across;
    if (chord >= least_ && chord <= most_) runs.push_back({row_, first, last});
  }

  const float* range_;
  const std::uint8_t* breaks_;
  int columns_, row_;
  float jump_, angle_, steep_, least_, most_;
};

}  // namespace

void find_ring_runs(const RingImage& image, const RunLimits& limits, std::vector<RingRun>& runs) {
  runs.clear();
  std::vector<std::uint8_t> breaks;
  for (int row = 0; row < image.rows; ++row) RingWalk(image, row, limits, breaks).add_runs(runs);
}

}  // namespace ca2
