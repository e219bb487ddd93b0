/// @file What the supervisor needs of a device, whatever kind of sensor it is.
#pragma once

#include <map>
#include <string>

#include "core/types/result.h"
#include "messages/status.h"

namespace ca2 {

/// One thread calls everything but interrupt().
class SensorDevice {
 public:
  enum class Event {
    alive,  ///< data, or none for now
    lost,   ///< to be closed and opened again
    ended,  ///< a recording is over
  };
  struct Step {
    Event event = Event::alive;
    std::string reason;  ///< when lost
  };

  virtual ~SensorDevice() = default;
  /// May block for seconds.
  virtual Result<void> open() = 0;
  /// Takes in what is there; waits for it a quarter of a second at most.
  virtual Step step() = 0;
  virtual void close() = 0;
  /// Makes step() return at once; from any thread.
  virtual void interrupt() noexcept = 0;

  /// The rig's sensors that it serves, with what is known of them: device, lost, clock_sigma.
  virtual std::map<std::string, SensorHealth> health() const = 0;
};

}  // namespace ca2
