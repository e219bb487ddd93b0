#include "tools/ca2/print_calibration.h"

#include <algorithm>
#include <cmath>

#include "core/types/text.h"

namespace ca2 {
namespace {

std::string pose_text(const Pose& T) {
  const Eigen::Quaterniond q = T.quaternion();
  return formatted("  translation  %+.5f %+.5f %+.5f m\n  rotation     x %+.6f  y %+.6f  z %+.6f  w %+.6f\n",
                   T.t.x(), T.t.y(), T.t.z(), q.x(), q.y(), q.z(), q.w());
}

}  // namespace

std::string describe(const Calibration& calibration) {
  std::string out;
  for (const CalibratedTransform& transform : calibration.transforms) {
    out += formatted("T_%s_%s (maps points of %s to %s)\n", transform.parent.c_str(), transform.child.c_str(),
                     transform.child_frame.c_str(), transform.parent_frame.c_str());
    out += pose_text(transform.T_parent_child);
    out += formatted("  sigma        %.2f mm, %.2f mrad\n", 1e3 * transform.sigma_translation(),
                     1e3 * transform.sigma_rotation());
  }
  for (const auto& [name, lidar] : calibration.lidars) {
    out += formatted("%s: noise %.1f mm per return", name.c_str(), 1e3 * lidar.range_sigma);
    if (lidar.estimated)
      out += formatted(", range bias %+.1f +- %.1f mm", 1e3 * lidar.range_bias, 1e3 * lidar.range_bias_sigma);
    out += '\n';
  }
  const auto used =
      std::count_if(calibration.views.begin(), calibration.views.end(), [](const auto& v) { return v.used; });
  out += formatted("views: %ld of %zu used; reprojection %.3f px rms, ranges %.1f mm rms",
                   static_cast<long>(used), calibration.views.size(), calibration.validation.reprojection_rms,
                   1e3 * calibration.validation.range_rms);
  if (std::isfinite(calibration.validation.leave_one_out_translation)) {
    out += formatted("; leaving one out moves the answer by %.2f mm, %.2f mrad",
                     1e3 * calibration.validation.leave_one_out_translation,
                     1e3 * calibration.validation.leave_one_out_rotation);
  }
  out += '\n';
  for (const CalibratedView& view : calibration.views) {
    if (!view.used) out += formatted("  view %d not used: %s\n", view.id, view.reason.c_str());
  }
  for (const std::string& note : calibration.notes) out += "note: " + note + '\n';
  out += formatted("verdict: %s; weakest: %s\n", calibration.observability.verdict.c_str(),
                   calibration.observability.weakest_direction.c_str());
  return out;
}

}  // namespace ca2
