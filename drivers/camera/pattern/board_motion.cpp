#include "drivers/camera/pattern/board_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace ca2 {
namespace {

constexpr double max_tilt = 40 * std::numbers::pi / 180;
constexpr double max_roll = 20 * std::numbers::pi / 180;
constexpr double least_share = 0.35,
                 most_share = 0.75;  // of the picture's smaller side that the board covers
constexpr double rim = 0.02;         // of the picture's smaller side that stays free

}  // namespace

Pose BoardMotion::pose(std::int64_t number) const {
  std::mt19937_64 random(options_.seed * 1'000'003 + static_cast<std::uint64_t>(number));
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
  };
  const Eigen::Vector2d size = board_.type->pattern_size(board_) + Eigen::Vector2d::Constant(board_.square);
  const double focal = camera_.parameters[0];
  const double side = std::min(camera_.width, camera_.height);
  Pose pose;
  for (;;) {
    const double distance = focal * size.maxCoeff() / (side * uniform(least_share, most_share));
    const double axis = uniform(0, 2 * std::numbers::pi), tilt = uniform(0.2, 1) * max_tilt;
    pose.R = so3_exp(tilt * Eigen::Vector3d(std::cos(axis), std::sin(axis), 0)) *
             so3_exp(uniform(-max_roll, max_roll) * Eigen::Vector3d::UnitZ());
    const Eigen::Vector2d pixel(uniform(0, camera_.width), uniform(0, camera_.height));
    pose.t = distance / focal *
             Eigen::Vector3d(pixel.x() - camera_.parameters[2], pixel.y() - camera_.parameters[3], focal);
    bool inside = true;
    for (const double x : {-0.5, 0.5}) {
      for (const double y : {-0.5, 0.5}) {
        const auto corner = camera_.project(pose * Eigen::Vector3d(x * size.x(), y * size.y(), 0));
        inside = inside && corner && camera_.contains(*corner, rim * side);
      }
    }
    if (inside) return pose;
  }
}

BoardMotion::Place BoardMotion::at(double time) const {
  const double turn = options_.hold + options_.move;
  const double number = std::floor(time / turn);
  Place place;
  place.pose = static_cast<std::int64_t>(number);
  const Pose from = pose(place.pose);
  const double moved = time - number * turn - options_.hold;  // s since it was picked up
  place.moving = moved > 0;
  if (!place.moving) {
    place.T_camera_board = from;
    return place;
  }
  // The way of a hand: least jerk.
  const double s = std::min(1.0, moved / options_.move);
  const double share = s * s * s * (10 - 15 * s + 6 * s * s);
  place.T_camera_board = from.perturbed(share * from.difference(pose(place.pose + 1)));
  return place;
}

}  // namespace ca2
