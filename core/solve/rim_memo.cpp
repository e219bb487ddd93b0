#include "core/solve/rim_memo.h"

#include <cmath>

namespace ca2 {
namespace {

/// Sums are what was measured, in directions of the sensor: where the plate was held to be only chose the
/// crossings and parted their angles. A move of the plate's rim up to this changes neither, m..
constexpr double near = 1e-4;
/// ..nor does one of the dilation up to this, rad.
constexpr double near_angle = 5e-5;

}  // namespace

bool RimMemo::Key::good_for(const Key& other) const {
  if (size != other.size || center != other.center || blur != other.blur || slack != other.slack)
    return false;
  const Vector6d move = T_lidar_board.difference(other.T_lidar_board);
  const double reach = move.tail<3>().norm() + move.head<3>().norm() * (0.5 * size.norm() + center.norm());
  const double range = other.T_lidar_board.t.norm();
  return reach <= near && std::abs(dilation.at(range) - other.dilation.at(range)) <= near_angle;
}

std::vector<EdgeSums> RimMemo::sums(std::span<const EdgeCrossing> crossings, const Outline& outline,
                                    const Pose& T_lidar_board, const Dilation& dilation,
                                    const EdgeNoise& noise, double slack) {
  const Key key{{outline.width, outline.height}, outline.center, T_lidar_board, dilation, noise.blur, slack};
  if (!key_ || !key_->good_for(key)) {
    sums_ = edge_sums(crossings, outline, T_lidar_board, dilation, {noise.blur, 0, 0, 0}, slack);
    key_ = key;
  }
  std::vector<EdgeSums> sums = sums_;
  if (noise.shared > 0 || noise.backdrop > 0) {
    for (EdgeSums& side : sums) side.share(noise);
  }
  return sums;
}

}  // namespace ca2
