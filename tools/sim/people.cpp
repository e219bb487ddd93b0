/// People of ellipsoids and capsules, roughly 1.75 m tall.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tools/sim/furnishing.h"

namespace ca2 {
namespace {

struct Clothes {
  Material skin, shirt, trousers;
};

Clothes draw_clothes(std::mt19937_64& rng) {
  std::uniform_real_distribution<double> uniform(0, 1);
  const Material skin{0.35 + 0.25 * uniform(rng), 0.55, Texture::plain, 0.3, 0};
  const Material shirt{0.1 + 0.6 * uniform(rng), 0.4 + 0.4 * uniform(rng), Texture::stripes, 0.11, 0.15};
  const Material trousers{0.08 + 0.2 * uniform(rng), 0.2 + 0.3 * uniform(rng), Texture::plain, 0.3, 0};
  return {skin, shirt, trousers};
}

void add_limb(Scene& scene, const Eigen::Vector3d& from, const Eigen::Vector3d& to, double radius,
              const Material& material) {
  const Eigen::Vector3d axis = to - from;
  if (axis.norm() < 1e-6) return;
  Solid limb;
  limb.shape = Shape::capsule;
  limb.T_rig_solid.R =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), axis.normalized()).toRotationMatrix();
  limb.T_rig_solid.t = (from + to) / 2;
  limb.size = {radius, radius, axis.norm() / 2};
  limb.material = material;
  scene.add(limb);
}

void add_ellipsoid(Scene& scene, const Pose& T_rig_solid, const Eigen::Vector3d& half,
                   const Material& material) {
  Solid solid;
  solid.shape = Shape::ellipsoid;
  solid.T_rig_solid = T_rig_solid;
  solid.size = half;
  solid.material = material;
  scene.add(solid);
}

/// Trunk, head and legs; the body frame has x towards the rig, z up and its origin between the shoulders.
void add_body(Scene& scene, const Pose& T_rig_body, double floor_z, const Clothes& clothes) {
  add_ellipsoid(scene, {T_rig_body.R, T_rig_body * Eigen::Vector3d(0, 0, -0.26)}, {0.13, 0.21, 0.36},
                clothes.shirt);
  add_ellipsoid(scene, {T_rig_body.R, T_rig_body * Eigen::Vector3d(0.02, 0, 0.2)}, {0.1, 0.08, 0.13},
                clothes.skin);
  for (const double side : {-1.0, 1.0}) {
    const Eigen::Vector3d hip = T_rig_body * Eigen::Vector3d(0, 0.1 * side, -0.55);
    const double height = hip.z() - floor_z;
    // Who holds the board low kneels: the thighs point forward as far as the legs are too long to stand.
    constexpr double leg = 0.85;
    const double forward = height < leg ? 0.5 * std::sqrt(leg * leg - height * height) : 0;
    const Eigen::Vector3d knee = hip + T_rig_body.R * Eigen::Vector3d(-0.15 * forward, 0.03 * side, 0) -
                                 Eigen::Vector3d(0, 0, height / 2);
    const Eigen::Vector3d foot =
        Eigen::Vector3d(knee.x(), knee.y(), floor_z + 0.06) - T_rig_body.R * Eigen::Vector3d(forward, 0, 0);
    add_limb(scene, hip, knee, 0.085, clothes.trousers);
    add_limb(scene, knee, foot, 0.065, clothes.trousers);
  }
}

/// A body frame at a place on the floor, turned to the rig.
Pose body_at(const Eigen::Vector2d& p, double shoulder_z) {
  const Eigen::Vector2d to_rig = -p.normalized();
  Pose T_rig_body;
  T_rig_body.R.col(0) = Eigen::Vector3d(to_rig.x(), to_rig.y(), 0);
  T_rig_body.R.col(2) = Eigen::Vector3d::UnitZ();
  T_rig_body.R.col(1) = T_rig_body.R.col(2).cross(T_rig_body.R.col(0));
  T_rig_body.t = {p.x(), p.y(), shoulder_z};
  return T_rig_body;
}

}  // namespace

void add_holder(Scene& scene, const Room& room, const Plate& plate, const Pose& T_rig_plate,
                std::mt19937_64& rng) {
  const Clothes clothes = draw_clothes(rng);
  const auto on_plate = [&](double sx, double sy) {
    const Eigen::Vector2d p =
        plate.outline.center + Eigen::Vector2d(sx * plate.outline.width, sy * plate.outline.height) / 2;
    return Eigen::Vector3d(p.x(), p.y(), plate.height(p));
  };
  const Eigen::Vector3d center = T_rig_plate * on_plate(0, 0);
  const Eigen::Vector2d away = center.head<2>().normalized();
  // Nothing of the body touches the plate, however it is tilted.
  double depth = 0;
  for (const double sx : {-1.0, 1.0}) {
    for (const double sy : {-1.0, 1.0}) {
      const Eigen::Vector3d corner = T_rig_plate * on_plate(sx, sy);
      depth = std::max(depth, (corner - center).head<2>().dot(away));
    }
  }
  const double floor_z = -room.rig_height;
  const double shoulder_z = std::clamp(center.z() + 0.25, floor_z + 0.85, floor_z + 1.45);
  const Pose T_rig_body = body_at(center.head<2>() + (depth + 0.32) * away, shoulder_z);
  add_body(scene, T_rig_body, floor_z, clothes);

  const Eigen::Vector3d hand_half(0.045, 0.055, 0.035);
  for (const double side : {-1.0, 1.0}) {
    Eigen::Vector3d grip = on_plate(side, std::uniform_real_distribution<double>(-0.1, 0.4)(rng));
    grip.x() += side * (hand_half.x() - room.hand_cover);
    const Eigen::Vector3d hand = T_rig_plate * grip;
    add_ellipsoid(scene, {T_rig_plate.R, hand}, hand_half, clothes.skin);
    // The body looks at the rig: its left arm (+y) holds whichever edge lies on its left.
    const double arm = (T_rig_body.inverse() * hand).y() < 0 ? -1 : 1;
    const Eigen::Vector3d shoulder = T_rig_body * Eigen::Vector3d(0, 0.2 * arm, -0.03);
    const Eigen::Vector3d wrist = hand + 0.05 * (T_rig_plate.R.col(2) + side * T_rig_plate.R.col(0));
    const Eigen::Vector3d elbow =
        (shoulder + wrist) / 2 + T_rig_body.R * Eigen::Vector3d(-0.03, 0.1 * arm, -0.12);
    add_limb(scene, shoulder, elbow, 0.05, clothes.shirt);
    add_limb(scene, elbow, wrist, 0.038, clothes.shirt);
  }
}

void add_walker(Scene& scene, const Room& room, const Eigen::Vector2d& place, std::mt19937_64& rng) {
  const Pose T_rig_body = body_at(place, -room.rig_height + 1.45);
  const Clothes clothes = draw_clothes(rng);
  add_body(scene, T_rig_body, -room.rig_height, clothes);
  for (const double side : {-1.0, 1.0}) {
    const Eigen::Vector3d shoulder = T_rig_body * Eigen::Vector3d(0, 0.21 * side, -0.03);
    const Eigen::Vector3d elbow = T_rig_body * Eigen::Vector3d(-0.03, 0.27 * side, -0.33);
    const Eigen::Vector3d wrist = T_rig_body * Eigen::Vector3d(0.08, 0.26 * side, -0.6);
    add_limb(scene, shoulder, elbow, 0.05, clothes.shirt);
    add_limb(scene, elbow, wrist, 0.038, clothes.shirt);
    add_ellipsoid(scene, {T_rig_body.R, wrist}, {0.05, 0.035, 0.07}, clothes.skin);
  }
}

void add_bystander(Scene& scene, const Room& room, const Eigen::Vector3d& p_kept_clear,
                   std::mt19937_64& rng) {
  const double clear = std::atan2(p_kept_clear.y(), p_kept_clear.x());
  // At least 35 degrees beside the line of sight, 1.5 m or more away and off the walls.
  const double angle = clear + std::uniform_real_distribution<double>(0.6, 2 * std::numbers::pi - 0.6)(rng);
  const double reach = std::min(room.length, room.width) / 2 - 0.6;
  const double distance = std::uniform_real_distribution<double>(std::min(1.5, reach), reach)(rng);
  add_walker(scene, room, distance * Eigen::Vector2d(std::cos(angle), std::sin(angle)), rng);
}

}  // namespace ca2
