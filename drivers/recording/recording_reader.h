/// @file All sensors' data of a recording in the order in which a host would have had it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/types/image.h"
#include "core/types/scan.h"
#include "drivers/lidar/counters.h"
#include "drivers/recording/recording.h"

namespace ca2 {

/// A picture or a scan.
struct RecordedFrame {
  int sensor = 0;                      ///< index among the rig's cameras or LiDARs, by name
  std::int64_t time = 0;               ///< ns UTC: the middle of the exposure or of the revolution
  std::int64_t arrival = 0;            ///< ns UTC: when it was complete
  std::shared_ptr<const Image> image;  ///< of a camera
  std::shared_ptr<const Scan> scan;    ///< of a LiDAR, times on the host's clock
};

class RecordingReader {
 public:
  /// A sensor of the rig without data in the recording is a warning; ErrorCode::data when none has any.
  static Result<RecordingReader> open(const Recording& recording);
  RecordingReader(RecordingReader&&) noexcept;
  RecordingReader& operator=(RecordingReader&&) noexcept;
  ~RecordingReader();

  /// By rising arrival; cameras before LiDARs, by name, at the same time. Nothing at the end. Pictures that
  /// cannot be read are counted and left out; a damaged capture ends that LiDAR with a warning.
  std::optional<RecordedFrame> next();

  /// What went wrong so far without stopping the rest.
  const std::vector<Problem>& warnings() const;
  /// Of all pictures in the recording (known from the start) and those given out: for progress.
  int pictures() const;
  int pictures_read() const;

 private:
  struct State;
  explicit RecordingReader(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace ca2
