/// @file The capture pipeline: from searched pictures and scans to stored views, a solve after each, and
/// words for the person. A pure state machine: times are passed in, and whatever takes time or touches the
/// world (searching, writing, solving) is done by the host, which the daemon and `ca2 replay` both are.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "core/capture/observation.h"
#include "core/capture/options.h"
#include "core/capture/status.h"
#include "core/session/calibration.h"
#include "core/session/rig.h"
#include "core/session/session.h"
#include "core/types/result.h"

namespace ca2 {

/// To be written and searched (store_view.h), so that the features are those that a later `ca2 solve` finds;
/// the answer goes to CapturePipeline::stored.
struct StoreView {
  int id = 0;
  std::map<std::string, Image> images;  ///< by camera: the mean over the hold
  std::map<std::string, std::vector<std::shared_ptr<const Scan>>> scans;  ///< by LiDAR: of the hold
  std::map<std::string, Pick> picks;                                      ///< by LiDAR
  std::string details;                                                    ///< view.yaml
};

/// To be solved (solve_views.h); the answer goes to CapturePipeline::solved. A newer request replaces one
/// under way.
struct SolveViews {
  std::uint64_t number = 0;
  std::shared_ptr<const Rig> rig;  ///< with the pictures' sizes filled in
  std::shared_ptr<const std::vector<ViewSights>> views;
};

/// A view is to be taken out of the session (`drop`).
struct DropView {
  int id = 0;
};

/// Something to tell a person and the log.
struct CaptureEvent {
  std::int64_t time = 0;  ///< ns UTC
  std::string kind;       ///< "captured", "rejected", "solved", "dropped", "sensor", ...: one word
  std::string text;
};

using CaptureAction = std::variant<StoreView, SolveViews, DropView, CaptureEvent>;
using CaptureActions = std::vector<CaptureAction>;

class CapturePipeline {
 public:
  /// `views` are those the session has already, with what was found in them. The rig's cameras should have
  /// intrinsics: without them a camera's views are captured, and solved once they can be estimated.
  CapturePipeline(Rig rig, CaptureOptions options, std::vector<ViewSights> views);
  ~CapturePipeline();

  CaptureActions add(const CameraObservation& observation);
  CaptureActions add(const LidarObservation& observation);
  /// Time passes without data: at least 5 times per second.
  CaptureActions tick(std::int64_t now);

  /// `now`: take what is there without waiting for stillness.
  CaptureActions capture(std::int64_t time, bool now);
  CaptureActions set_automatic(std::int64_t time, bool on);
  /// A person's pixel in a LiDAR's projection by ID: the board is where it points, until the board moves on.
  CaptureActions pick(std::int64_t time, int lidar, int row, int column, double radius);
  CaptureActions drop(std::int64_t time, int id);
  /// Where the board has an outline one view may do; else it takes three. They are asked for by themselves.
  CaptureActions solve(std::int64_t time);

  /// The host's answers. A view counts from `stored` on.
  CaptureActions stored(std::int64_t time, int id, Result<ViewSights> answer);
  CaptureActions solved(std::int64_t time, std::uint64_t number, const Result<Calibration>& answer);

  CaptureStatus status(std::int64_t now) const;
  /// The newest answer; nothing before the first.
  const Calibration* calibration() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace ca2
