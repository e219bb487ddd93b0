/// @file When a camera that should send pictures must be taken for gone.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <optional>

namespace ca2 {

/// Three frame periods without a sign of life, where a period is what the camera promises or, if longer, what
/// it lately kept. Pure: times are passed in. What the host slept through is not held against the camera.
class FrameWatch {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using Duration = std::chrono::steady_clock::duration;

  /// Pictures are to come every `period` (zero: when they come, nothing is watched) from `now` on; the first
  /// may take `first` longer.
  void begin(Time now, Duration period, Duration first) {
    period_ = period;
    last_.reset();
    intervals_ = {};
    deadline_ = now + first + 3 * period;
  }

  /// A picture, whole or not.
  void sign_of_life(Time now) {
    if (last_) {
      intervals_[next_] = now - *last_;
      next_ = (next_ + 1) % intervals_.size();
    }
    last_ = now;
    deadline_ = now + 3 * period();
  }

  /// Part of a picture.
  void heard(Time time) { deadline_ = std::max(deadline_, time + 3 * period()); }

  /// Who waits for pictures begins to look, and ends: after an absence of more than a period, what came
  /// meanwhile is not known yet.
  void look(Time now) {
    if (now - left_ > period()) deadline_ = std::max(deadline_, now + period());
  }
  void leave(Time now) { left_ = now; }
  /// The waiting thread woke this much later than it wanted: the host was busy.
  void overslept(Duration late) { deadline_ += late; }

  /// When it is over; nothing where nothing is watched.
  std::optional<Time> deadline() const {
    return period_ > Duration::zero() ? std::optional(deadline_) : std::nullopt;
  }
  /// Since the last picture; since never: nothing.
  std::optional<Duration> silence(Time now) const {
    return last_ ? std::optional(now - *last_) : std::nullopt;
  }

 private:
  Duration period() const {
    return std::max(period_, *std::max_element(intervals_.begin(), intervals_.end()));
  }

  Duration period_{0};
  std::optional<Time> last_;
  std::array<Duration, 4> intervals_{};  ///< the latest
  std::size_t next_ = 0;
  Time deadline_, left_;
};

}  // namespace ca2
