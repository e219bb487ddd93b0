/// @file A plate's rim as rings whose rays lie on a grid cross it.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/board/board.h"
#include "core/lidar/edge_crossings.h"
#include "core/solve/edge_sums.h"

namespace ca2 {

inline const Outline test_plate{0.6, 0.4, {0.01, -0.02}};

/// A plate 2 m ahead of a sensor with x forward, turned about its normal by `roll`.
inline Pose plate_at(double roll) {
  Eigen::Matrix3d axes;
  axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return {axes * Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY()) *
              Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()),
          {2, 0.1, 0.05}};
}

/// What a scan of the plate is like.
struct RimScan {
  double phase = 0;        ///< of the columns, in columns
  Dilation dilation = {};  ///< of the rim as the rays see it
  double depth = 0;        ///< of the rim behind the print, m
  double lens = 0;         ///< m: in front of the axis, where the beams begin; the crossings do not say so
};

inline std::vector<EdgeCrossing> scan_rim(const Pose& T_lidar_board, const RimScan& how) {
  constexpr double step = 0.0035;  // rad, between columns
  constexpr double ring_step = 0.006;
  const auto on_plate = [&](const Eigen::Vector3d& ray) {
    const double w = 0.5 * test_plate.width, h = 0.5 * test_plate.height;
    const Eigen::Vector2d corners[]{{w, h}, {w, -h}, {-w, -h}, {-w, h}};
    const Eigen::Vector3d start(0, 0, -how.lens * ray.z() / ray.head<2>().norm());
    for (std::size_t i = 0; i < 4; ++i) {
      const auto end = [&](const Eigen::Vector2d& c) {
        const Eigen::Vector2d place = test_plate.center + c;
        return Eigen::Vector3d(T_lidar_board * Eigen::Vector3d(place.x(), place.y(), how.depth) - start);
      };
      const Eigen::Vector3d a = end(corners[i]), b = end(corners[(i + 1) % 4]);
      if (a.cross(b).normalized().dot(ray) > how.dilation.at((0.5 * (a + b)).norm())) return false;
    }
    return true;
  };
  std::vector<EdgeCrossing> crossings;
  for (int ring = -60; ring <= 60; ++ring) {
    const auto ray = [&](int column) {
      const double azimuth = (column + how.phase) * step, elevation = ring * ring_step;
      return Eigen::Vector3d(std::cos(azimuth) * std::cos(elevation), std::sin(azimuth) * std::cos(elevation),
                             std::sin(elevation));
    };
    for (int column = -150; column < 150; ++column) {
      const Eigen::Vector3d here = ray(column), next = ray(column + 1);
      if (on_plate(here) == on_plate(next)) continue;
      const bool leaves = on_plate(here);
      crossings.push_back({(leaves ? here : next).cast<float>(), (leaves ? next : here).cast<float>(), 1,
                           static_cast<std::uint16_t>(ring + 60), false});
    }
  }
  return crossings;
}

}  // namespace ca2
