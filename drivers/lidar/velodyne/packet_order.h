/// @file Puts packets back in the order they were measured in, by the sensor's own time stamps.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "drivers/lidar/counters.h"
#include "drivers/lidar/velodyne/packet.h"

namespace ca2 {

/// A packet in its turn.
struct OrderedPacket {
  const std::uint8_t* bytes = nullptr;
  std::int64_t device_time = 0;  ///< ns: UTC as far as the sensor's us within the hour tell
  std::int64_t host_time = 0;    ///< ns
  double gap = 0;                ///< s that no packet covers before this one; 0: follows its predecessor
  bool restart = false;          ///< the clock jumped: what was before has no relation to this
};

/// A packet that follows the last one is passed on at once. One beyond a gap waits until what belongs before
/// it has come, or until `depth` packets wait; so does the first. Copies of packets and packets from before
/// what was passed on are dropped.
class VelodynePacketOrder {
 public:
  using Sink = std::function<void(const OrderedPacket&)>;

  /// `period`: s that the packet covers.
  void push(const std::uint8_t* packet, std::int64_t host_time, double period, LidarCounters& counters,
            const Sink& sink);
  /// Passes on what waits, and forgets.
  void flush(LidarCounters& counters, const Sink& sink);

  /// For packets without time stamps (HDL-64E S1): in the order of arrival, less immediate copies.
  void push_untimed(const std::uint8_t* packet, std::int64_t host_time, double period,
                    LidarCounters& counters, const Sink& sink);

 private:
  struct Waiting {
    std::array<std::uint8_t, VelodynePacket::bytes> bytes;
    std::int64_t host_time;
    std::int64_t since;  ///< us after the last packet passed on
    double period;
  };

  void pass(const std::uint8_t* packet, std::int64_t host_time, std::int64_t since, double period,
            LidarCounters& counters, const Sink& sink);
  void start_before(std::uint32_t stamp);
  void pass_waiting(bool all, LidarCounters& counters, const Sink& sink);
  bool seen(std::uint32_t stamp) const;
  void remember(std::uint32_t stamp);

  static constexpr std::size_t depth = 8;
  bool started_ = false;
  bool fresh_ = false;            ///< nothing has been passed on since the start
  bool jumped_ = false;           ///< the start was a jump of the clock
  std::uint32_t last_stamp_ = 0;  ///< us
  std::int64_t device_time_ = 0;  ///< ns, of the last packet passed on
  double last_period_ = 0;        ///< s that it covers
  int late_run_ = 0;
  std::vector<Waiting> waiting_;            ///< by time
  std::array<std::uint32_t, 32> stamps_{};  ///< of the last packets, to tell copies from late ones
  std::size_t stamp_count_ = 0;
  std::array<std::uint8_t, VelodynePacket::bytes> untimed_{};
};

}  // namespace ca2
