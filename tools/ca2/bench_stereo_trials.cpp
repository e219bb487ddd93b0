#include "tools/ca2/bench_stereo_trials.h"

#include <algorithm>
#include <optional>

#include "core/solve/calibrate.h"
#include "tools/sim/calibration_trials.h"
#include "tools/sim/feature_sights.h"

namespace ca2 {
namespace {

/// T_camera_lidar of the rig's camera `index`; nothing where the answer has none.
std::optional<Pose> found(const Calibration& answer, const Rig& rig, std::size_t index) {
  const std::string& camera = std::next(rig.cameras.begin(), static_cast<std::ptrdiff_t>(index))->first;
  for (const CalibratedTransform& transform : answer.transforms) {
    if (transform.parent == camera && transform.child == rig.lidars.begin()->first)
      return transform.T_parent_child;
  }
  return std::nullopt;
}

/// Of a rig with one camera: the other one is not there.
std::optional<Pose> calibrate_alone(const StereoPool& pool, const std::vector<ViewSights>& views,
                                    std::size_t index, const CalibrateOptions& options) {
  Rig rig = pool.rig;
  rig.cameras.erase(std::next(rig.cameras.begin(), index == 0 ? 1 : 0));
  std::vector<ViewSights> seen = views;
  for (ViewSights& view : seen) view.cameras = {view.cameras[index]};
  const auto answer = calibrate(rig, seen, options);
  return answer ? found(*answer, rig, 0) : std::nullopt;
}

std::optional<Pose> baseline_apart(const StereoPool& pool, const std::vector<ViewSights>& views,
                                   const CalibrateOptions& options) {
  const auto left = calibrate_alone(pool, views, 0, options);
  const auto right = left ? calibrate_alone(pool, views, 1, options) : std::nullopt;
  if (!right) return std::nullopt;
  return *left * right->inverse();
}

Result<Pose> baseline_at_once(const StereoPool& pool, const std::vector<ViewSights>& views,
                              const CalibrateOptions& options) {
  const auto answer = calibrate(pool.rig, views, options);
  if (!answer) return fail(answer.error());
  const auto left = found(*answer, pool.rig, 0), right = found(*answer, pool.rig, 1);
  if (!left || !right)
    return fail(ErrorCode::refused, "", "the views do not tie both cameras to the LiDAR", "");
  return *left * right->inverse();
}

}  // namespace

Result<void> keep_stereo(StereoPool& pool) {
  if (pool.rig.cameras.size() < 2 || pool.rig.lidars.empty()) {
    return fail(ErrorCode::config, "", "the rig has not two cameras and a LiDAR",
                "`ca2 bench stereo` compares the calibrations of two cameras to one LiDAR");
  }
  pool.rig.extrinsics.clear();
  pool.rig.cameras.erase(std::next(pool.rig.cameras.begin(), 2), pool.rig.cameras.end());
  pool.rig.lidars.erase(std::next(pool.rig.lidars.begin()), pool.rig.lidars.end());
  for (ViewSights& view : pool.views) {
    view.cameras.resize(2);
    view.lidars.resize(1);
  }
  std::erase_if(pool.views, [](const ViewSights& view) {
    return !view.cameras[0] || !view.cameras[1] || view.lidars[0].empty();
  });
  return {};
}

void try_subset(const StereoPool& pool, std::mt19937_64& rng, StereoCell& cell) {
  const std::vector<ViewSights> views = draw_subset(pool.views, cell.views, rng);
  const std::vector<ViewSights> planes = without_crossings(views);
  CalibrateOptions joint;
  joint.estimated = pool.estimated;
  CalibrateOptions kim = joint, plane_to_plane = joint;
  kim.method = Method::kim;
  plane_to_plane.method = Method::plane_to_plane;
  std::array<std::optional<Pose>, stereo_methods.size()> answers;
  // The hardest to determine first: what it refuses need not be tried further.
  answers[2] = baseline_apart(pool, planes, joint);
  if (!answers[2]) return;
  answers[0] = baseline_apart(pool, planes, kim);
  answers[1] = baseline_apart(pool, planes, plane_to_plane);
  answers[3] = baseline_apart(pool, views, joint);
  if (const auto all = baseline_at_once(pool, views, joint)) answers[4] = *all;
  if (!std::all_of(answers.begin(), answers.end(), [](const auto& answer) { return answer.has_value(); }))
    return;
  ++cell.subsets;
  for (std::size_t m = 0; m < answers.size(); ++m) {
    const Vector6d error = pool.T_left_right.difference(*answers[m]);
    cell.errors[m].translation.push_back(error.tail<3>().norm());
    cell.errors[m].rotation.push_back(error.head<3>().norm());
  }
}

Result<Pose> baseline_of_all(const StereoPool& pool) {
  CalibrateOptions options;
  options.estimated = pool.estimated;
  return baseline_at_once(pool, pool.views, options);
}

}  // namespace ca2
