/// @file Packets into frames: a pure state machine.
#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <span>

#include "drivers/lidar/counters.h"
#include "drivers/lidar/ouster/frame.h"
#include "drivers/lidar/ouster/packet.h"

namespace ca2 {

/// A column's place is its measurement id, a packet's frame its frame id; both arrive in any order. A frame
/// is given out when all its packets are there, or when newer frames have had `hold` packets (what comes out
/// of order on a network is a few packets late, not a frame). Frames come out by rising frame id, each once.
class OusterFrameAssembler {
 public:
  using Sink = std::function<void(const OusterFrame&)>;

  /// `extra_fields`: decode signal and near infrared too, which points do not need.
  OusterFrameAssembler(const OusterMetadata& metadata, bool extra_fields);

  /// A lidar packet of this format (classify_ouster_packet said so).
  void push(std::span<const std::uint8_t> packet, std::uint32_t frame_id, std::int64_t host_time,
            LidarCounters& counters, const Sink& sink);

  /// Gives out what is under way: the end of a recording, or of a sensor's configuration.
  void flush(LidarCounters& counters, const Sink& sink);

 private:
  /// A frame under way.
  struct Slot {
    OusterFrame frame;
    std::vector<bool> received;  ///< by packet of the frame
    int expected_received = 0;   ///< of the packets the window lets expect
  };

  std::int64_t later(std::uint32_t a, std::uint32_t b) const;
  Slot* slot_for(std::uint32_t frame_id, LidarCounters& counters, const Sink& sink);
  Slot fresh_slot(std::uint32_t frame_id);
  void add_columns(Slot& slot, const std::uint8_t* packet, std::int64_t host_time, LidarCounters& counters);
  void decode_column(OusterFrame& frame, const std::uint8_t* column, int id) const;
  void close_oldest(LidarCounters& counters, const Sink& sink);
  void close_finished(LidarCounters& counters, const Sink& sink);

  OusterFormat format_;
  bool extra_fields_;
  std::vector<bool> expected_;  ///< by packet of a frame
  int expected_count_ = 0;
  std::deque<Slot> slots_;               ///< by rising frame id
  std::vector<Slot> spare_;              ///< given out, its memory for the next
  std::optional<std::uint32_t> closed_;  ///< the newest frame given out
  int late_run_ = 0;                     ///< packets in a row that were too old
};

}  // namespace ca2
