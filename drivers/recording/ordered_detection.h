/// @file Searches frames on several threads and gives them back in their order.
#pragma once

#include <cstdint>
#include <memory>
#include <variant>

#include "core/capture/observation.h"
#include "core/session/rig.h"
#include "drivers/recording/recording_reader.h"

namespace ca2 {

struct SearchedFrame {
  std::int64_t arrival = 0;  ///< ns UTC
  std::variant<CameraObservation, LidarObservation> observation;
};

/// Looks ahead in a recording by a bounded number of frames. Every sensor's frames are searched in their
/// order, as its detector remembers; what comes out depends on no thread's timing.
class OrderedDetection {
 public:
  OrderedDetection(const Rig& rig, RecordingReader& reader, int threads);
  ~OrderedDetection();

  /// Null at the recording's end.
  std::unique_ptr<SearchedFrame> next();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace ca2
