#include "core/capture/next_view.h"

#include <algorithm>
#include <cmath>

namespace ca2 {
namespace {

ElevationRange elevations(const Scan& scan) {
  ElevationRange range{M_PI / 2, -M_PI / 2};
  for (const Eigen::Vector3f& point : scan.points) {
    const float distance = point.norm();
    if (!(distance > 0.1f)) continue;  // NaN, or no return
    const double elevation = std::asin(std::clamp(point.z() / distance, -1.f, 1.f));
    range.low = std::min(range.low, elevation);
    range.high = std::max(range.high, elevation);
  }
  return range.low < range.high ? range : ElevationRange{};
}

bool reached(const Calibration& calibration, const SigmaTarget& target) {
  return std::all_of(calibration.transforms.begin(), calibration.transforms.end(), [&](const auto& t) {
    return t.sigma_translation() <= target.translation && t.sigma_rotation() <= target.rotation;
  });
}

}  // namespace

std::optional<NextPose> next_view(const GuidanceSetting& setting,
                                  const std::optional<Calibration>& calibration,
                                  const std::vector<ViewSights>& views) {
  if (!calibration) return suggest_first_pose(setting.rig, views);
  const SigmaTarget target{setting.options.target_sigma_translation, setting.options.target_sigma_rotation};
  if (reached(*calibration, target)) return std::nullopt;
  std::vector<ElevationRange> lidars;
  for (const LidarTrack& track : setting.tracks.lidars) {
    lidars.push_back(track.newest() != nullptr ? elevations(*track.newest()->scan) : ElevationRange{});
  }
  return suggest_next_pose(setting.rig, *calibration, views, lidars, target);
}

}  // namespace ca2
