#include "core/solve/joint_start.h"

#include <limits>

namespace ca2 {

JointInput first_input(const Board& board, const std::vector<Camera>& cameras, std::size_t lidars,
                       const JointOptions& options) {
  JointInput input;
  input.board_corners = board.type->corners(board);
  input.cameras = cameras;
  input.relative = options.relative;
  input.prior_intrinsics = options.prior_intrinsics;
  input.prior_bias = options.prior_bias;
  input.stated = options.stated;
  input.prior_dilation = dilation_sigma;
  input.edge_sway.assign(lidars, 0);
  return input;
}

JointState first_state(const std::vector<Camera>& cameras, std::size_t lidars,
                       const std::vector<ViewSights>& views, const RigSeed& seed) {
  JointState state;
  state.T_ref_camera = seed.T_ref_camera;
  state.T_ref_lidar = seed.T_ref_lidar;
  state.cameras = cameras;
  state.range_bias = state.range_slope = std::vector<double>(lidars, 0);
  state.dilation.resize(lidars);
  state.T_ref_board = seeded_boards(views, seed);
  return state;
}

JointAnswer first_answer(std::size_t cameras, std::size_t lidars, std::size_t views, const RigSeed& seed) {
  JointAnswer answer;
  answer.chosen = seed.chosen;
  answer.by_rims = seed.by_rims;
  answer.views.resize(views);
  answer.range_sigma.assign(lidars, 0.02);
  answer.view_sigma.assign(lidars, 0);
  answer.edge_noise.resize(lidars);
  answer.outline_offset.assign(lidars, std::numeric_limits<double>::quiet_NaN());
  answer.corner_scale.assign(cameras, 1);
  return answer;
}

}  // namespace ca2
