/// @file A sensor's clock against the host's, from the times its packets arrive.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

namespace ca2 {

/// Device time to host time, an affine map with its uncertainty. A value: one of them serves a whole scan,
/// so that the scan's inner times are consistent.
struct ClockMapping {
  std::int64_t device_reference = 0;  ///< ns on the device's clock
  std::int64_t host_reference = 0;    ///< ns UTC at that device time
  double drift = 0;                   ///< host seconds per device second, minus 1
  double sigma_at_reference = 0;      ///< ns
  double sigma_drift = 0;             ///< as drift

  /// ns UTC. It is the time of arrival of a packet sent at `device` that was not held up, so later than the
  /// sending by what the network takes at least; sigma_ns covers that.
  std::int64_t to_host(std::int64_t device) const;
  double sigma_ns(std::int64_t device) const;
};

struct DeviceClockOptions {
  std::int64_t window = 20'000'000'000;       ///< ns of device time looked back on
  std::int64_t slot = 200'000'000;            ///< ns of which the least delayed packet is kept
  double max_drift = 200e-6;                  ///< crystals are within 100 ppm of each other
  double fixed_sigma = 100'000;               ///< ns: least delay and stamping, which nothing here can see
  double first_sigma = 1'000'000;             ///< ns: jitter to assume while there are few packets
  std::int64_t jump_tolerance = 100'000'000;  ///< ns
  std::int64_t jump_confirm = 500'000'000;    ///< ns of host time a late offset must last to be a jump
};

/// Packets arrive late by chance but never early: host minus device time has the true offset as its lower
/// envelope. Over a window, the envelope is the line under all points that is closest to them (the linear
/// program of Moon, Skelly and Towsley, INFOCOM 1999), found on the lower convex hull. Pure: all times are
/// passed in.
class DeviceClock {
 public:
  explicit DeviceClock(DeviceClockOptions options = {}) : options_(options) {}

  enum class Update {
    first,  ///< the first packet
    regular,
    suspect,  ///< later than the envelope by more than the tolerance; may be a jump
    jump,     ///< the clock was set, or the sensor restarted: everything before is forgotten
  };

  /// A packet stamped `device` (ns, must not wrap: see hour_clock.h) arrived at `host` (ns UTC).
  Update update(std::int64_t device, std::int64_t host);

  /// Nothing before the first packet.
  const std::optional<ClockMapping>& mapping() const { return mapping_; }

  std::uint64_t jumps() const { return jumps_; }

 private:
  struct Point {
    std::int64_t device = 0;
    std::int64_t offset = 0;  ///< host - device, ns
  };

  void restart(const Point& point);
  void fit();
  bool jumped(const Point& point, std::int64_t host, Update& verdict);

  DeviceClockOptions options_;
  std::deque<Point> slots_;  ///< the least offset of each slot, oldest first
  std::optional<ClockMapping> mapping_;
  std::int64_t newest_ = 0;                    ///< device time, ns
  std::optional<std::int64_t> suspect_since_;  ///< host time, ns
  std::uint64_t jumps_ = 0;
};

}  // namespace ca2
