/// @file Tells models that share a product number apart, by the pace of their packets.
#pragma once

#include <cmath>
#include <cstdint>

namespace ca2 {

/// An HDL-32E's number is that of a VLP-16 with firmware of 2014 too. What is read as the other one has
/// packets 0.42 or 2.4 times its own period apart; packets that are lost make whole multiples. Any other pace
/// (a capture that was made up, or cut) says nothing.
class VelodynePacketPace {
 public:
  /// `stamp`: us within the hour; `period`: s that a packet of the model covers. True from when the packets
  /// are another model's beyond doubt.
  bool other_model(std::uint32_t stamp, double period) {
    const auto apart = static_cast<std::int64_t>(stamp) - last_;
    const bool first = last_ < 0;
    last_ = stamp;
    const double periods = static_cast<double>(apart) / (1e6 * period);
    if (other_ || first || apart <= 0 || periods > 8) return other_;
    const auto whole = [](double count, double off) {
      return count > 0.5 && std::abs(count - std::round(count)) < off;
    };
    // The slower one's losses make multiples of its own period.
    const bool fits = whole(periods, 0.15);
    const bool other = std::abs(periods - ratio) < 0.04 || whole(ratio * periods, 0.03);
    fitting_ += fits ? 1 : 0;
    strange_ += other && !fits ? 1 : 0;
    other_ = strange_ >= 4 && strange_ > 4 * fitting_;
    return other_;
  }
  bool other_model() const { return other_; }

 private:
  /// Of an HDL-32E's 12 firings of 46.08 us to a VLP-16's 24 of 55.296 us; the same with two returns.
  static constexpr double ratio = 12 * 46.08 / (24 * 55.296);

  std::int64_t last_ = -1;
  std::int64_t fitting_ = 0, strange_ = 0;
  bool other_ = false;
};

}  // namespace ca2
