#include "drivers/lidar/ouster/geometry.h"

#include <cmath>
#include <numbers>

#include "drivers/lidar/lanes.h"

namespace ca2 {

OusterGeometry make_ouster_geometry(const OusterMetadata& metadata) {
  constexpr double radian = std::numbers::pi / 180;
  constexpr double mm = 1e-3;
  OusterGeometry out;
  out.origin_x = metadata.beam_origin_x * mm;
  out.origin_z = metadata.beam_origin_z * mm;
  // The vendor takes the signed offset when it lies in the plane, else the length.
  out.origin_range = out.origin_z == 0 ? out.origin_x : std::hypot(out.origin_x, out.origin_z);
  out.t = metadata.lidar_to_sensor.topRightCorner<3, 1>() * mm;

  const Eigen::Map<const Eigen::ArrayXd> altitude(metadata.altitude.data(),
                                                  static_cast<Eigen::Index>(metadata.altitude.size()));
  const Eigen::Map<const Eigen::ArrayXd> azimuth(metadata.azimuth.data(),
                                                 static_cast<Eigen::Index>(metadata.azimuth.size()));
  out.a = (altitude * radian).cos() * (azimuth * radian).cos();
  out.b = -(altitude * radian).cos() * (azimuth * radian).sin();
  out.c = (altitude * radian).sin();
  for (const auto& [from, to] :
       {std::pair{&out.a, &out.a_lanes}, std::pair{&out.b, &out.b_lanes}, std::pair{&out.c, &out.c_lanes}}) {
    to->assign(static_cast<std::size_t>(lanes::padded(static_cast<int>(from->size()))), 0.0f);
    for (Eigen::Index row = 0; row < from->size(); ++row) {
      (*to)[static_cast<std::size_t>(row)] = static_cast<float>((*from)[row]);
    }
  }
  const Eigen::Matrix3d R = metadata.lidar_to_sensor.topLeftCorner<3, 3>();
  out.columns.reserve(static_cast<std::size_t>(metadata.columns_per_frame));
  for (int column = 0; column < metadata.columns_per_frame; ++column) {
    // The head turns clockwise seen from above: azimuth falls as the measurement id rises.
    const double encoder =
        2 * std::numbers::pi * (1.0 - column / static_cast<double>(metadata.columns_per_frame));
    Eigen::Matrix3d turn;
    turn << std::cos(encoder), -std::sin(encoder), 0, std::sin(encoder), std::cos(encoder), 0, 0, 0, 1;
    const Eigen::Matrix3d M = R * turn;
    const Eigen::Matrix3f single = M.cast<float>();
    const Eigen::Vector3d base = out.t + M * Eigen::Vector3d(out.origin_x, 0, out.origin_z);
    const bool upright =
        single.row(2) == Eigen::RowVector3f(0, 0, 1) && single.col(2) == Eigen::Vector3f(0, 0, 1);
    out.columns.push_back({M, single, base.cast<float>(), upright});
  }
  return out;
}

}  // namespace ca2
