/// @file A world of simple solids that rays can be cast at.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/geometry/pose.h"
#include "tools/sim/plate.h"

namespace ca2 {

enum class Texture { plain, blotches, stripes, tiles };

struct Material {
  double albedo = 0.5;        ///< visible light, 0..1, diffuse
  double reflectivity = 0.5;  ///< near infrared, 0..1, diffuse
  Texture texture = Texture::plain;
  double scale = 0.3;     ///< m, of the texture
  double contrast = 0.2;  ///< relative, of the texture
};

enum class Shape {
  box,        ///< `size`: half edges
  room,       ///< the same seen from the inside
  ellipsoid,  ///< `size`: half axes
  capsule,    ///< along z: `size.z()` is half the length of its axis, `size.x()` the radius
  plate,      ///< `plate`
};

struct Solid {
  Shape shape = Shape::box;
  Pose T_rig_solid;
  Eigen::Vector3d size = Eigen::Vector3d::Zero();  ///< m
  Material material;
  Plate plate;
  const Board* print = nullptr;  ///< what is printed on a plate; nullptr: nothing

  double bounding_radius = 0;  ///< m, round T_rig_solid.t; Scene::add sets it
};

/// Where a ray meets a solid.
struct SolidHit {
  int solid = -1;         ///< index into Scene::solids; -1: nothing is hit
  int face = 0;           ///< of a box: 0..5
  double distance = 0;    ///< m, along the ray
  Eigen::Vector3d point;  ///< in the solid's frame, m

  /// Hits with equal ids lie on one smooth surface.
  int surface() const { return 6 * solid + face; }
};

struct Scene {
  std::vector<Solid> solids;               ///< filled by `add`
  Eigen::Vector3d lamp = {0.5, 0.3, 1.6};  ///< rig frame, m

  /// Returns the solid's index.
  int add(Solid solid);

  /// The nearest of all solids along the unit `direction` (rig frame).
  SolidHit cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;
  /// The nearest of the solids whose indices are given.
  SolidHit cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                std::span<const int> solids) const;

  /// Unit normal at a hit, rig frame, towards the origin of the ray `direction`.
  Eigen::Vector3d normal(const SolidHit& hit, const Eigen::Vector3d& direction) const;
  /// Relative change of the material's albedo and reflectivity at a hit (without any print).
  double texture(const SolidHit& hit) const;
  /// Light at a hit on a surface with this normal: 1 is what exposes white paper well.
  double light(const SolidHit& hit, const Eigen::Vector3d& normal) const;
};

}  // namespace ca2
