/// @file The capture pipeline over a recording: what the daemon would have captured, without its threads.
#pragma once

#include <functional>
#include <map>

#include "core/capture/pipeline.h"
#include "core/session/session.h"
#include "drivers/recording/recording_reader.h"

namespace ca2 {

struct ReplayOptions {
  CaptureOptions capture;
  int threads = 0;   ///< that search; 0: as many as there are cores
  double speed = 0;  ///< 1: as it was recorded; 0: as fast as possible
  std::function<void(const CaptureEvent&)> event;
  /// Called after every frame, with the pipeline as it is.
  std::function<void(const CapturePipeline&, std::int64_t now)> progress;
};

struct ReplayReport {
  std::map<int, std::int64_t> stored;  ///< views by id: ns UTC of the recording's clock at which they were
  int failed = 0;                      ///< views that could not be
};

/// Adds the views of the recording to the session. The same recording and session give the same files, bit
/// for bit, whatever the speed and the threads. Fails (ErrorCode::io, cannot_create) when no view at all
/// could be stored; views that are there already are extracted first.
Result<ReplayReport> replay(const Rig& rig, RecordingReader& reader, Session& session,
                            const ReplayOptions& options);

/// The session of a recording: created with the recording's rig and the LiDARs' files, or opened where it is
/// there. ErrorCode::config where it is of another rig.
Result<Session> session_of(const Recording& recording, const std::filesystem::path& directory);

}  // namespace ca2
