#include "messages/extrinsics.h"

#include <algorithm>
#include <ca2/extrinsics_v1_t.hpp>

#include "messages/pose_forms.h"

namespace ca2 {

extrinsics_v1_t to_lcm(const Calibration& calibration, const std::string& session, std::int64_t time) {
  extrinsics_v1_t out;
  out.utime = time / 1000;
  out.session = session;
  out.verdict = calibration.observability.verdict;
  out.views = static_cast<std::int32_t>(std::count_if(calibration.views.begin(), calibration.views.end(),
                                                      [](const CalibratedView& view) { return view.used; }));
  for (const CalibratedTransform& transform : calibration.transforms) {
    transform_v1_t& message = out.transforms.emplace_back();
    message.parent = transform.parent;
    message.child = transform.child;
    message.parent_frame = transform.parent_frame;
    message.child_frame = transform.child_frame;
    message.pose = pose_to_lcm(transform.T_parent_child);
    for (int row = 0; row < 6; ++row) {
      for (int column = 0; column < 6; ++column)
        message.covariance[6 * row + column] = transform.covariance(row, column);
    }
    message.sigma_translation = transform.sigma_translation();
    message.sigma_rotation = transform.sigma_rotation();
  }
  out.transform_count = static_cast<std::int32_t>(out.transforms.size());
  return out;
}

}  // namespace ca2
