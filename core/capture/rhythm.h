/// @file How regularly a sensor delivers.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

namespace ca2 {

/// Arrival times of the last 2 seconds (ns), of a slow sensor the last four.
class Rhythm {
 public:
  void add(std::int64_t time) {
    if (!times_.empty() && time < times_.back()) times_.clear();  // the clock was set back
    times_.push_back(time);
    while (times_.size() > fewest && times_.front() < time - window) times_.pop_front();
    period_ = middle_gap();
  }

  /// Middle gap between arrivals, ns; nothing before the third. Lost frames do not change it.
  std::optional<std::int64_t> period() const { return period_; }

  /// Per second.
  double rate() const {
    if (times_.size() < 2 || times_.back() == times_.front()) return 0;
    return 1e9 * static_cast<double>(times_.size() - 1) / static_cast<double>(times_.back() - times_.front());
  }

  /// Nothing came for two periods, and what detection takes.
  bool silent(std::int64_t now) const {
    constexpr std::int64_t detection = 100'000'000, unknown = 500'000'000;
    return times_.empty() || now - times_.back() > 2 * period().value_or(unknown) + detection;
  }

 private:
  std::optional<std::int64_t> middle_gap() const {
    if (times_.size() < 3) return std::nullopt;
    std::vector<std::int64_t> gaps;
    for (std::size_t i = 1; i < times_.size(); ++i) gaps.push_back(times_[i] - times_[i - 1]);
    std::nth_element(gaps.begin(), gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2), gaps.end());
    return gaps[gaps.size() / 2];
  }

  static constexpr std::int64_t window = 2'000'000'000;
  static constexpr std::size_t fewest = 4;  // the middle of three gaps survives one lost frame
  std::deque<std::int64_t> times_;
  std::optional<std::int64_t> period_;
};

}  // namespace ca2
