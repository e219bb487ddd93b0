/// @file From a session's files to what the estimator needs: corners, board poses, patches.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "core/features/sights.h"
#include "core/session/session.h"
#include "core/types/result.h"

namespace ca2 {

struct ExtractOptions {
  int threads = 0;                                    ///< 0: as many as there are cores
  bool cache = true;                                  ///< keep features in SESSION/cache
  std::vector<int> views;                             ///< ids to use; empty: all
  std::function<void(int done, int total)> progress;  ///< called from the calling thread only
};

struct Extraction {
  Rig rig;                        ///< the session's, with every camera's intrinsics filled in
  std::vector<ViewSights> views;  ///< by rising id; sensors in the rig's order (by name)
  /// Cameras whose intrinsics came from the views: standard deviation of each parameter.
  std::map<std::string, Eigen::VectorXd> estimated;
  std::vector<Problem> problems;  ///< files that could not be used; the other views are fine
  int searched = 0;               ///< pictures and clouds searched
  int cached = 0;                 ///< taken from the cache
};

/// Finds the board in every picture and cloud of the session, on all cores. A file that cannot be used is a
/// problem of its view. The whole fails only when no file of a sensor can be used (ErrorCode::data), a sensor
/// never saw the board or has too few views to estimate its intrinsics (ErrorCode::refused), an unknown view
/// is asked for (ErrorCode::usage), or the rig lacks a camera or a LiDAR (ErrorCode::config).
Result<Extraction> extract_features(const Session& session, const ExtractOptions& options);

/// One view that was just written, for whoever keeps the others: its features, left in SESSION/cache too. A
/// camera whose intrinsics are not known has corners and no pose (the identity). Fails as extract_features
/// does; ErrorCode::data where a file of the view cannot be used.
Result<ViewSights> extract_view(const Session& session, int id);

}  // namespace ca2
