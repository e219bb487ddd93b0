#include "core/solve/beam_center.h"

#include <array>
#include <cmath>

#include "core/geometry/adjoint.h"

namespace ca2 {
namespace {

constexpr std::size_t max_rings = 256;
constexpr double least_count = 50;
constexpr double least_spread = 0.1;     // m rms: of a ring's radii
constexpr double largest_rest = 0.0005;  // m rms: off the line; more is no cone about the z axis
constexpr double least_center = 0.003;   // m: not worth a move
constexpr double most_center = 0.3;      // m: larger than any sensor
constexpr double most_scatter = 0.05;    // m rms: of the rings' own places

/// Sums for a line z = z0 + slope * radius.
struct RingLine {
  double count = 0, r = 0, z = 0, rr = 0, rz = 0, zz = 0;

  void add(const Eigen::Vector3f& point) {
    const double radius = std::hypot(double{point.x()}, double{point.y()}), height = point.z();
    count += 1;
    r += radius;
    z += height;
    rr += radius * radius;
    rz += radius * height;
    zz += height * height;
  }
};

}  // namespace

Eigen::Vector3d beam_center(const std::vector<ViewSights>& views, std::size_t lidar) {
  std::array<RingLine, max_rings> rings;
  for (const ViewSights& view : views) {
    for (const LidarSight& sight : view.lidars[lidar]) {
      for (const auto* returns : {&sight.on_board, &sight.around}) {
        for (const BoardReturn& here : *returns) {
          if (here.ring < max_rings && here.point.allFinite()) rings[here.ring].add(here.point);
        }
      }
    }
  }
  double sum = 0, squares = 0, weight = 0;
  for (const RingLine& ring : rings) {
    if (ring.count < least_count) continue;
    const double n = ring.count, variance = ring.rr / n - ring.r * ring.r / (n * n);
    if (!(variance > least_spread * least_spread)) continue;
    const double covariance = ring.rz / n - ring.r * ring.z / (n * n);
    const double rest = ring.zz / n - ring.z * ring.z / (n * n) - covariance * covariance / variance;
    if (!(rest < largest_rest * largest_rest)) continue;
    const double height = (ring.z - covariance / variance * ring.r) / n;  // on the axis
    sum += n * height;
    squares += n * height * height;
    weight += n;
  }
  if (!(weight > 0)) return Eigen::Vector3d::Zero();
  const double center = sum / weight, scatter = squares / weight - center * center;
  const bool known = std::abs(center) < most_center && scatter < most_scatter * most_scatter;
  return known && std::abs(center) > least_center ? Eigen::Vector3d(0, 0, center) : Eigen::Vector3d(0, 0, 0);
}

void move_origin(std::vector<ViewSights>& views, std::size_t lidar, const Eigen::Vector3d& center) {
  for (ViewSights& view : views) {
    for (LidarSight& sight : view.lidars[lidar]) {
      for (EdgeCrossing& crossing : sight.crossings) {
        for (Eigen::Vector3f* ray : {&crossing.inside, &crossing.outside}) {
          // Both are where a ray meets the board's plane.
          const Eigen::Vector3d direction = ray->cast<double>();
          const double reach = -sight.plane.offset / sight.plane.normal.dot(direction);
          *ray = (reach * direction - center).normalized().cast<float>();
        }
      }
      for (auto* returns : {&sight.on_board, &sight.around}) {
        for (BoardReturn& here : *returns) here.point -= center.cast<float>();
      }
      sight.plane.offset += sight.plane.normal.dot(center);
      sight.center -= center;
    }
  }
}

void restore_origin(JointAnswer& answer, std::size_t lidar, Eigen::Index first,
                    const Eigen::Vector3d& center) {
  const Pose T_center_sensor{Eigen::Matrix3d::Identity(), -center};
  answer.state.T_ref_lidar[lidar] = answer.state.T_ref_lidar[lidar] * T_center_sensor;
  const Matrix6d turn = adjoint(T_center_sensor.inverse());
  if (answer.covariance.allFinite()) {
    answer.covariance.middleRows<6>(first) = (turn * answer.covariance.middleRows<6>(first)).eval();
    answer.covariance.middleCols<6>(first) =
        (answer.covariance.middleCols<6>(first) * turn.transpose()).eval();
  }
  if (answer.leave_one_out.rows() > 0)
    answer.leave_one_out.middleCols<6>(first) =
        (answer.leave_one_out.middleCols<6>(first) * turn.transpose()).eval();
}

}  // namespace ca2
