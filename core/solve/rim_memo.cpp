#include "core/solve/rim_memo.h"

namespace ca2 {

bool RimMemo::Key::operator==(const Key& other) const {
  return size == other.size && center == other.center && T_lidar_board.R == other.T_lidar_board.R &&
         T_lidar_board.t == other.T_lidar_board.t && dilation.angle == other.dilation.angle &&
         dilation.margin == other.dilation.margin && blur == other.blur && slack == other.slack;
}

std::vector<EdgeSums> RimMemo::sums(std::span<const EdgeCrossing> crossings, const Outline& outline,
                                    const Pose& T_lidar_board, const Dilation& dilation,
                                    const EdgeNoise& noise, double slack) {
  const Key key{{outline.width, outline.height}, outline.center, T_lidar_board, dilation, noise.blur, slack};
  if (!key_ || !(*key_ == key)) {
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
