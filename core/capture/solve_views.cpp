#include "core/capture/solve_views.h"

#include <algorithm>

#include "core/intrinsics/estimate_intrinsics.h"
#include "core/solve/calibrate.h"

namespace ca2 {
namespace {

/// The camera's intrinsics from the corners of its views, and the poses that follow.
Result<IntrinsicsEstimate> estimate(const Board& board, RigCamera& camera, std::size_t index,
                                    std::vector<ViewSights>& views) {
  std::vector<std::vector<Corner>> corners;
  for (const ViewSights& view : views) {
    if (view.cameras[index]) corners.push_back(view.cameras[index]->corners);
  }
  Result<IntrinsicsEstimate> found =
      estimate_intrinsics(board, camera.width, camera.height, camera.model, corners);
  if (!found) return found;
  camera.intrinsics = found->camera;
  for (ViewSights& view : views) {
    std::optional<CameraSight>& sight = view.cameras[index];
    if (!sight) continue;
    const Result<BoardPose> pose = estimate_board_pose(board, found->camera, sight->corners);
    if (pose)
      sight->pose = *pose;
    else
      sight.reset();
  }
  return found;
}

}  // namespace

Result<Calibration> solve_views(const SolveViews& request, const std::stop_token& stop) {
  Rig rig = *request.rig;
  CalibrateOptions options;
  options.stop = stop;
  // A session's sights are a megabyte per view: copied only where poses are to be filled in.
  const auto known = [](const auto& entry) { return entry.second.intrinsics.has_value(); };
  if (std::all_of(rig.cameras.begin(), rig.cameras.end(), known))
    return calibrate(rig, *request.views, options);
  std::vector<ViewSights> views = *request.views;
  std::vector<Problem> refusals;
  std::size_t index = 0;
  for (auto& [name, camera] : rig.cameras) {
    const std::size_t at = index++;
    if (camera.intrinsics || stop.stop_requested()) continue;
    const Result<IntrinsicsEstimate> found = estimate(rig.board, camera, at, views);
    if (found) {
      options.estimated[name] = found->covariance.diagonal().cwiseSqrt();
      continue;
    }
    for (Problem problem : found.error().problems) {
      problem.where = name + (problem.where.empty() ? "" : ": " + problem.where);
      refusals.push_back(std::move(problem));
    }
  }
  if (!refusals.empty()) return fail(ErrorCode::refused, std::move(refusals));
  if (stop.stop_requested())
    return fail(ErrorCode::unavailable, "", "the solve was stopped before it had an answer");
  return calibrate(rig, views, options);
}

}  // namespace ca2
