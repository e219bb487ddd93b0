#include "core/solve/plate_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/lidar/rectangle_fit.h"
#include "core/solve/edge_noise.h"
#include "core/solve/lidar_terms.h"

namespace ca2 {
namespace {

/// How far the rim may lie from where it is looked for, m, step by step.
constexpr std::array slacks{0.06, 0.04, 0.025, 0.015, 0.015};
/// More than this share of a rim, or of the returns, on the wrong side of the plate's: it is another thing's.
constexpr double most_contradicting = 0.1, most_beside = 0.03;
/// A straight rim passes through any two crossings: so many rings must cross it where it is, and so large a
/// share of those that do; what lies between two rings only bounds it.
constexpr std::size_t least_crossings = 6;
constexpr double least_on_rim = 0.7;
/// A ray is on the wrong side of a rim only when it is by so much: m, and of the distance (wide beams).
constexpr double tolerance = 0.015, tolerance_share = 0.004;
/// A crossing is on it within this.
constexpr double near_rim = 0.006, near_rim_share = 0.003;
/// Sides that are seen of it at least.
constexpr std::size_t least_sides = 3;
/// The returns of a patch may be off together by so much, m.
constexpr double range_doubt = 0.012;

/// Axes in a plane, about a point of it.
struct Sheet {
  Plane plane;
  Eigen::Vector3d origin, u, v;

  Sheet(const Plane& in, const Eigen::Vector3d& centre)
      : plane(in), origin(centre - in.distance(centre) * in.normal) {
    u = in.normal.unitOrthogonal();
    v = -in.normal.cross(u);  // u, v and the axis away from the sensor are right-handed
  }
  explicit Sheet(const Pose& T)
      : plane{-T.R.col(2), T.R.col(2).dot(T.t)}, origin(T.t), u(T.R.col(0)), v(T.R.col(1)) {}

  /// Where a ray that begins `height` up the z axis meets it.
  std::optional<Eigen::Vector2d> meet(const Eigen::Vector3f& ray, float height) const {
    const Eigen::Vector3d from(0, 0, height), along = ray.cast<double>();
    const double reach = -plane.distance(from) / plane.normal.dot(along);
    if (!(reach > 0)) return std::nullopt;
    return place(from + reach * along);
  }
  Eigen::Vector2d place(const Eigen::Vector3d& p) const { return {u.dot(p - origin), v.dot(p - origin)}; }

  Pose pose(const PlaneRectangle& rectangle) const {
    Pose pose;
    const Eigen::Vector3d x = rectangle.cosine * u + rectangle.sine * v, z = -plane.normal;
    pose.R << x, z.cross(x), z;
    pose.t = origin + rectangle.u * u + rectangle.v * v;
    return pose;
  }
};

PlaneRectangle rough_place(const LidarSight& sight, const Sheet& sheet, const Outline& outline) {
  std::vector<PlaneSample> samples;
  const auto add = [&](const Eigen::Vector2d& p, int weight) {
    samples.push_back({static_cast<float>(p.x()), static_cast<float>(p.y()), weight});
  };
  const std::size_t step = 1 + sight.on_board.size() / 300;
  for (std::size_t i = 0; i < sight.on_board.size(); i += step)
    add(sheet.place(sight.on_board[i].point.cast<double>()), 4);
  for (const EdgeCrossing& crossing : sight.crossings) {
    if (const auto p = sheet.meet(crossing.inside, crossing.inside_height)) add(*p, 20);
    if (const auto p = sheet.meet(crossing.outside, crossing.outside_height)) add(*p, -20);
  }
  return fit_rectangle(samples, outline.width, outline.height);
}

/// By how much a place on the plate's plane is outside of the plate, m; negative: inside.
double outside(const Outline& plate, const Eigen::Vector2d& p) {
  return std::max(std::abs(p.x()) - 0.5 * plate.width, std::abs(p.y()) - 0.5 * plate.height);
}

/// Are returns and rim those of a plate that lies there, but for strays?
bool agrees(const LidarSight& sight, const Outline& plate, const Pose& T_lidar_plate) {
  const double slack = tolerance + tolerance_share * T_lidar_plate.t.norm();
  const Sheet sheet(T_lidar_plate);
  const double near = near_rim + near_rim_share * T_lidar_plate.t.norm();
  std::size_t beside = 0, wrong = 0, telling = 0, by_rings = 0, on_rim = 0;
  for (const BoardReturn& here : sight.on_board)
    beside += outside(plate, sheet.place(here.point.cast<double>())) > slack ? 1 : 0;
  for (const EdgeCrossing& crossing : sight.crossings) {
    if (crossing.jump < least_jump) continue;
    const auto on = sheet.meet(crossing.inside, crossing.inside_height);
    const auto past = sheet.meet(crossing.outside, crossing.outside_height);
    if (!on || !past) continue;
    const double last = outside(plate, *on), next = outside(plate, *past);
    ++telling;
    wrong += last > slack || next < -slack ? 1 : 0;
    if (crossing.across_rings) continue;
    ++by_rings;
    on_rim += last < near && next > -near ? 1 : 0;
  }
  if (on_rim < least_crossings || static_cast<double>(on_rim) < least_on_rim * static_cast<double>(by_rings))
    return false;
  return static_cast<double>(beside) <= most_beside * static_cast<double>(sight.on_board.size()) &&
         static_cast<double>(wrong) <= most_contradicting * static_cast<double>(telling);
}

/// Moves the plate in its plane to where its rim was seen. Nothing where that is not the plate's.
std::optional<PlateFit> settled(const LidarSight& sight, const Outline& plate, const Pose& rough,
                                double normal_sigma) {
  using Matrix7d = Eigen::Matrix<double, 7, 7>;
  constexpr std::array in_plane{2, 3, 4, 6};  // of (rotation, translation, dilation)
  PlateFit fit{rough, Matrix6d::Zero()};
  LidarErrors errors;
  Matrix7d H;
  std::vector<EdgeSums> sides;
  for (const double slack : slacks) {
    for (int round = 0; round < 3; ++round) {
      EdgeNoise noise = usual_edge_noise;
      sides = edge_sums(sight.crossings, plate, fit.T_lidar_plate, errors.dilation, noise, slack);
      if (sides.size() < least_sides) return std::nullopt;
      for (const EdgeSums& side : sides) noise.blur = std::max(noise.blur, usual_edge_noise.blur + side.blur);
      sides = edge_sums(sight.crossings, plate, fit.T_lidar_plate, errors.dilation, noise, slack);
      SensorEquations equations;
      add_edges(sides, 0, fit.T_lidar_plate, errors, &equations);
      H = equations.H.topLeftCorner<7, 7>();
      Eigen::Matrix<double, 7, 1> g = equations.g.head<7>();
      H.row(6) = equations.H.row(7).head<7>();
      H.col(6) = equations.H.col(7).head<7>();
      H(6, 6) = equations.H(7, 7) + 1 / (dilation_sigma * dilation_sigma);
      g(6) = equations.g(7) + errors.dilation.angle / (dilation_sigma * dilation_sigma);
      const Eigen::LDLT<Eigen::Matrix4d> ldlt(H(in_plane, in_plane));
      if (ldlt.info() != Eigen::Success || !ldlt.isPositive()) return std::nullopt;
      const Eigen::Vector4d step = -ldlt.solve(g(in_plane));
      Vector6d move = Vector6d::Zero();
      move.segment<3>(2) = step.head<3>();
      if (!(move.norm() < 0.5)) return std::nullopt;
      fit.T_lidar_plate = fit.T_lidar_plate.perturbed(move);
      errors.dilation.angle += step(3);
    }
  }
  if (sides.size() < least_sides) return std::nullopt;
  if (!agrees(sight, plate, fit.T_lidar_plate)) return std::nullopt;
  const double flat = 1 / (normal_sigma * normal_sigma);
  H.diagonal().head<2>().array() += flat;
  H(5, 5) += 1 / (range_doubt * range_doubt);
  fit.covariance = H.ldlt().solve(Matrix7d::Identity()).topLeftCorner<6, 6>();
  return fit;
}

}  // namespace

std::vector<PlateFit> fit_plate(const LidarSight& sight, const Outline& outline, double normal_sigma) {
  std::vector<PlateFit> fits;
  if (sight.crossings.size() < least_crossings) return fits;
  const Sheet sheet(facing_origin(sight.plane), sight.center);
  const Outline plate{outline.width, outline.height, Eigen::Vector2d::Zero()};
  const Pose rough = sheet.pose(rough_place(sight, sheet, plate));
  Pose across = rough;
  across.R.col(0) = rough.R.col(1);
  across.R.col(1) = -rough.R.col(0);
  for (const Pose& way : {rough, across}) {
    if (const auto fit = settled(sight, plate, way, normal_sigma)) fits.push_back(*fit);
  }
  return fits;
}

}  // namespace ca2
