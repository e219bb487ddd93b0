#include "tools/sim/cramer_rao.h"

#include "core/geometry/scaled_inverse.h"
#include "core/solve/joint_problem.h"
#include "tools/sim/rim_simulator.h"

namespace ca2 {
namespace {

/// The corners a camera saw, without their noise.
std::vector<Corner> true_corners(const SimulatedView& view, const std::string& name, const Camera& camera,
                                 const std::vector<Eigen::Vector2d>& board_corners) {
  const auto seen = view.corners.find(name);
  if (seen == view.corners.end()) return {};
  std::vector<Corner> corners = seen->second;
  for (Corner& corner : corners) {
    const Eigen::Vector2d& xy = board_corners[static_cast<std::size_t>(corner.id)];
    if (const auto pixel = camera.project(view.T_sensor_board.at(name) * Eigen::Vector3d(xy.x(), xy.y(), 0)))
      corner.pixel = *pixel;
  }
  return corners;
}

std::optional<RangeSums> true_ranges(const SimulatedView& view, const std::string& name) {
  const auto rays = view.rays.find(name);
  if (rays == view.rays.end() || rays->second.empty()) return std::nullopt;
  const Plane plane = board_plane(view.T_sensor_board.at(name));
  const std::vector<float>& heights = view.heights.at(name);
  std::vector<BoardReturn> returns;
  for (std::size_t i = 0; i < rays->second.size(); ++i) {
    const BeamRay& ray = rays->second[i];
    const double range = -plane.distance(ray.origin) / plane.normal.dot(ray.direction);
    returns.push_back({(ray.origin + range * ray.direction).cast<float>(), BoardReturn::no_ring,
                       BoardReturn::no_intensity, heights[i]});
  }
  constexpr double gate = 0.1;  // m: all of them
  return range_sums(returns, inverse_plane(plane), 0, gate);
}

}  // namespace

std::optional<Matrix6d> cramer_rao(const Scenario& scenario, const Rig& rig,
                                   const std::vector<SimulatedView>& views, const BoundModel& model) {
  JointInput input;
  JointState state;
  input.board_corners = rig.board.type->corners(rig.board);
  input.prior_bias = model.prior_bias;
  input.prior_dilation = dilation_sigma;
  input.corner_huber = 1e9;
  const Pose T_ref_rig = scenario.T_rig_sensor(rig.cameras.begin()->first).inverse();
  for (const auto& [name, camera] : rig.cameras) {
    if (!(scenario.cameras.at(name).noise.corner_sigma > 0)) return std::nullopt;
    const Camera& truth = scenario.cameras.at(name).camera;
    input.cameras.push_back(truth);
    input.prior_intrinsics.emplace_back(Eigen::Vector4d(model.prior_focal * truth.parameters(0),
                                                        model.prior_focal * truth.parameters(1),
                                                        model.prior_center, model.prior_center));
    state.T_ref_camera.push_back(T_ref_rig * scenario.T_rig_sensor(name));
  }
  state.cameras = input.cameras;
  for (const auto& [name, lidar] : rig.lidars) {
    const LidarNoise& noise = scenario.lidars.at(name).noise;
    if (!(noise.range_sigma > 0)) return std::nullopt;
    input.range_sigma.push_back(noise.range_sigma);
    input.prior_range_slope.push_back(0);
    state.T_ref_lidar.push_back(T_ref_rig * scenario.T_rig_sensor(name));
    state.range_bias.push_back(0);
    state.range_slope.push_back(0);
    state.dilation.push_back({dilation_per_width * noise.divergence, dilation_per_width * noise.beam_width});
    input.edge_sway.push_back(0);
  }
  for (const SimulatedView& view : views) {
    const auto& [sensor, T_sensor_board] = *view.T_sensor_board.begin();
    state.T_ref_board.push_back(T_ref_rig * scenario.T_rig_sensor(sensor) * T_sensor_board);
    JointView& out = input.views.emplace_back();
    for (const auto& [name, camera] : rig.cameras)
      out.corners.push_back(true_corners(view, name, scenario.cameras.at(name).camera, input.board_corners));
    for (std::size_t l = 0; l < rig.lidars.size(); ++l) {
      const std::string& name = std::next(rig.lidars.begin(), static_cast<std::ptrdiff_t>(l))->first;
      out.ranges.push_back(true_ranges(view, name));
      std::vector<EdgeSums>& edges = out.edges.emplace_back();
      const auto crossings = view.crossings.find(name);
      if (!model.edges || crossings == view.crossings.end() || !rig.board.outline) continue;
      constexpr double slack = 0.01;  // m: the truth is not searched for
      edges = edge_sums(crossings->second, *rig.board.outline, view.T_sensor_board.at(name),
                        state.dilation[l], {}, slack);
    }
  }
  JointProblem problem(input);
  problem.linearize(state);
  const auto covariance = scaled_inverse(problem.information());
  if (!covariance) return std::nullopt;
  const auto i = static_cast<Eigen::Index>(problem.lidar_pose_index(0));
  return covariance->block<6, 6>(i, i);
}

}  // namespace ca2
