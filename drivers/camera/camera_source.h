/// @file What every camera driver is: pictures with host times, pulled by one capture thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/camera/camera_model.h"
#include "core/geometry/pose.h"
#include "core/session/rig.h"
#include "core/types/image.h"
#include "core/types/result.h"

namespace ca2 {

struct CameraFrame {
  int stream = 0;                      ///< which of the device's imagers: index into CameraSource::streams
  std::shared_ptr<const Image> image;  ///< grey or colour, full depth and size
  std::int64_t time = 0;               ///< ns UTC, host clock: the middle of the exposure
  std::int64_t time_sigma = 0;         ///< ns
  std::uint64_t sequence = 0;          ///< the device's own count
};

enum class CameraEvent {
  frame,
  timeout,  ///< nothing came in time; ask again
  stopped,  ///< interrupt() was called; stays so
  lost,     ///< the device is gone: close it and open it again
  end,      ///< a folder has no more; stays so
};

struct CameraPoll {
  CameraEvent event = CameraEvent::timeout;
  CameraFrame frame;   ///< when event is frame
  std::string reason;  ///< when event is lost: what was noticed
};

/// One imager of a device. A T265 has two; their frames of one `sequence` belong together.
struct CameraStream {
  std::string name;  ///< "" for a device of one imager; T265: "left", "right"
  int width = 0, height = 0;
  std::string format;                ///< the device's own name of its pixel format
  std::optional<Camera> intrinsics;  ///< factory calibration where the device has one
  std::optional<Pose> T_first_this;  ///< maps this imager's points to the first's, from the factory
};

/// One adjustable value of a device, as it is now.
struct CameraControl {
  std::string value;    ///< as last read back from the device
  std::string limits;   ///< "10 to 1000000", "off, software": for people
  std::string problem;  ///< why the last change did not take; empty when it did
};

/// Counts since opening. Every frame that should have been delivered and was not is in one of them: none of
/// before a start, of after a stop, or that is left out as the settings say.
struct CameraCounters {
  std::uint64_t frames = 0;      ///< delivered
  std::uint64_t incomplete = 0;  ///< damaged or partly lost on the way: never used
  std::uint64_t missed = 0;      ///< gaps in the device's own count
  std::uint64_t overrun = 0;     ///< dropped by us because nobody took them in time
  std::uint64_t resent = 0;      ///< packets that came when asked for again; no frame was lost by them

  /// Frames that never came to whoever asked for them.
  std::uint64_t lost() const { return incomplete + missed + overrun; }
};

/// An open device. One thread calls start(), next() and stop(); the others may be called from any.
class CameraSource {
 public:
  CameraSource() = default;
  CameraSource(const CameraSource&) = delete;
  CameraSource& operator=(const CameraSource&) = delete;
  virtual ~CameraSource() = default;

  virtual const std::vector<CameraStream>& streams() const = 0;
  /// "Allied Vision Manta G-145B, serial 50-0503..., firmware 1.2": for people and logs.
  virtual std::string description() const = 0;

  virtual Result<void> start() = 0;
  virtual CameraPoll next(std::chrono::milliseconds timeout) = 0;
  virtual void stop() = 0;
  /// Makes next() answer `stopped`, at once and from then on.
  virtual void interrupt() noexcept = 0;

  /// Pictures per second to expect; 0: they come when they come (a trigger, a folder). A source watches over
  /// it itself and answers `lost` or `timeout`.
  virtual double frame_rate() const = 0;

  /// Changes one control ("exposure_us", "gain_db", "frame_rate", "trigger": "off" or "software"). Answers at
  /// once, from any thread, and holds up neither next() nor the caller: name and value are checked here, the
  /// device is written to by the driver's own thread, and controls() says what became of it.
  virtual Result<void> set_control(const std::string& name, const std::string& value) = 0;
  virtual std::map<std::string, CameraControl> controls() const = 0;
  /// One picture now, where the control "trigger" is "software". As set_control.
  virtual Result<void> trigger() {
    return fail(ErrorCode::usage, description(), "has no software trigger", "");
  }

  virtual CameraCounters counters() const = 0;
  /// One imager's part of them, by its index in streams(): the parts add up to the whole. What is too damaged
  /// to say whose it was is the first's.
  virtual CameraCounters counters_of([[maybe_unused]] int stream) const { return counters(); }
  /// What a person should mend although it works: small receive buffers, small packets, a slow bus.
  virtual std::vector<std::string> warnings() const { return {}; }
};

}  // namespace ca2
