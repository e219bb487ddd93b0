#include "core/solve/held_values.h"

#include <string>

#include "core/solve/rim_conflict.h"
#include "core/types/text.h"

namespace ca2 {
namespace {

/// `free`: the answer of the same views, nothing held.
void judge(Calibration& calibration, const Calibration& free) {
  for (std::size_t i = 0; i < calibration.transforms.size(); ++i) {
    const CalibratedTransform &here = calibration.transforms[i], &there = free.transforms[i];
    const Vector6d change = there.T_parent_child.difference(here.T_parent_child);
    if (!beyond_chance(change, there.covariance)) continue;
    calibration.observability.verdict = "weak";
    calibration.notes.push_back(formatted(
        "what is held contradicts the views: without it T_%s_%s is another by %.2f mm and %.2f mrad, "
        "which its sigmas (%.2f mm, %.2f mrad) do not allow",
        here.parent.c_str(), here.child.c_str(), 1e3 * change.tail<3>().norm(), 1e3 * change.head<3>().norm(),
        1e3 * there.sigma_translation(), 1e3 * there.sigma_rotation()));
  }
}

}  // namespace

CalibrateOptions holding(CalibrateOptions options, const HeldValues& held) {
  if (held.intrinsics) options.prior_focal = options.prior_center = 0;
  if (held.ranges) options.prior_bias = 0;
  return options;
}

Result<Calibration> calibrate_holding(const Rig& rig, const std::vector<ViewSights>& views,
                                      const CalibrateOptions& options, const HeldValues& held) {
  Result<Calibration> answer = calibrate(rig, views, holding(options, held));
  if (!answer || !held.any()) return answer;
  const char* what = !held.ranges      ? "given intrinsics"
                     : held.intrinsics ? "given intrinsics, ranges"
                                       : "ranges";
  answer->notes.push_back(std::string("taken for exactly right, as asked: ") + what);
  if (const Result<Calibration> free = calibrate(rig, views, options)) judge(*answer, *free);
  return answer;
}

}  // namespace ca2
