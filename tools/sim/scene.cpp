#include "tools/sim/scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace ca2 {
namespace {

constexpr double nearest_surface = 0.02;  // m: a sensor does not see its own housing

struct LocalHit {
  double distance;
  int face;
};

/// The slab method; `inside` takes the exit instead of the entry.
std::optional<LocalHit> meet_box(const Eigen::Vector3d& half, const Eigen::Vector3d& o,
                                 const Eigen::Vector3d& d, bool inside) {
  double entry = -std::numeric_limits<double>::infinity();
  double exit = std::numeric_limits<double>::infinity();
  int entry_face = 0, exit_face = 0;
  for (int axis = 0; axis < 3; ++axis) {
    if (d[axis] == 0) {
      if (std::abs(o[axis]) > half[axis]) return std::nullopt;
      continue;
    }
    const double first = (-std::copysign(half[axis], d[axis]) - o[axis]) / d[axis];
    const double second = (std::copysign(half[axis], d[axis]) - o[axis]) / d[axis];
    const int forward = d[axis] > 0 ? 1 : 0;
    if (first > entry) {
      entry = first;
      entry_face = 2 * axis + 1 - forward;
    }
    if (second < exit) {
      exit = second;
      exit_face = 2 * axis + forward;
    }
  }
  if (entry > exit) return std::nullopt;
  return inside ? LocalHit{exit, exit_face} : LocalHit{entry, entry_face};
}

std::optional<LocalHit> meet_ellipsoid(const Eigen::Vector3d& half, const Eigen::Vector3d& o,
                                       const Eigen::Vector3d& d) {
  const Eigen::Vector3d p = o.cwiseQuotient(half), v = d.cwiseQuotient(half);
  const double a = v.squaredNorm(), b = p.dot(v), c = p.squaredNorm() - 1;
  const double discriminant = b * b - a * c;
  if (discriminant < 0) return std::nullopt;
  return LocalHit{(-b - std::sqrt(discriminant)) / a, 0};
}

std::optional<LocalHit> meet_capsule(double radius, double half, const Eigen::Vector3d& o,
                                     const Eigen::Vector3d& d) {
  const double a = d.head<2>().squaredNorm();
  const double b = o.head<2>().dot(d.head<2>());
  const double c = o.head<2>().squaredNorm() - radius * radius;
  const double discriminant = b * b - a * c;
  if (discriminant < 0) return std::nullopt;
  double end = o.z() < 0 ? -half : half;
  if (a > 0) {
    const double t = (-b - std::sqrt(discriminant)) / a;
    const double z = o.z() + t * d.z();
    if (std::abs(z) <= half) return LocalHit{t, 0};
    end = z < 0 ? -half : half;
  }
  const Eigen::Vector3d from_end = o - Eigen::Vector3d(0, 0, end);
  return meet_ellipsoid(Eigen::Vector3d::Constant(radius), from_end, d);
}

std::optional<LocalHit> meet(const Solid& solid, const Eigen::Vector3d& o, const Eigen::Vector3d& d) {
  switch (solid.shape) {
    case Shape::box:
      return meet_box(solid.size, o, d, false);
    case Shape::room:
      return meet_box(solid.size, o, d, true);
    case Shape::ellipsoid:
      return meet_ellipsoid(solid.size, o, d);
    case Shape::capsule:
      return meet_capsule(solid.size.x(), solid.size.z(), o, d);
    case Shape::plate:
      break;
  }
  const auto t = solid.plate.intersect(o, d);
  if (!t) return std::nullopt;
  return LocalHit{*t, 0};
}

/// A triangle wave of period 1 between -1 and 1: smooth enough for a wall, and cheap.
double wave(double x) {
  return 4 * std::abs(x - std::floor(x + 0.5)) - 1;
}

double smooth_step(double low, double high, double x) {
  const double s = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return s * s * (3 - 2 * s);
}

double bounding_radius(const Solid& solid) {
  const Eigen::Vector3d& size = solid.size;
  switch (solid.shape) {
    case Shape::ellipsoid:
      return size.maxCoeff();
    case Shape::capsule:
      return size.z() + size.x();
    case Shape::plate: {
      const Outline& outline = solid.plate.outline;
      return std::hypot(outline.width, outline.height) / 2 + outline.center.norm() +
             std::abs(solid.plate.bend);
    }
    case Shape::box:
    case Shape::room:
      break;
  }
  return size.norm();
}

void keep_nearer(const Solid& solid, int index, const Eigen::Vector3d& origin,
                 const Eigen::Vector3d& direction, SolidHit& best) {
  const double radius = solid.bounding_radius;
  const Eigen::Vector3d to_center = solid.T_rig_solid.t - origin;
  if (solid.shape != Shape::room) {
    const double along = to_center.dot(direction);
    if (to_center.squaredNorm() - along * along > radius * radius) return;
    if (along < -radius || (best.solid >= 0 && along - radius > best.distance)) return;
  }
  const Eigen::Vector3d o = solid.T_rig_solid.R.transpose() * -to_center;
  const Eigen::Vector3d d = solid.T_rig_solid.R.transpose() * direction;
  const auto hit = meet(solid, o, d);
  if (!hit || hit->distance < nearest_surface) return;
  if (best.solid >= 0 && hit->distance >= best.distance) return;
  best = {index, hit->face, hit->distance, o + hit->distance * d};
}

}  // namespace

int Scene::add(Solid solid) {
  solid.bounding_radius = bounding_radius(solid);
  solids.push_back(std::move(solid));
  return static_cast<int>(solids.size()) - 1;
}

SolidHit Scene::cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const {
  SolidHit best;
  for (std::size_t i = 0; i < solids.size(); ++i) {
    keep_nearer(solids[i], static_cast<int>(i), origin, direction, best);
  }
  return best;
}

SolidHit Scene::cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                     std::span<const int> indices) const {
  SolidHit best;
  for (const int i : indices) {
    const Solid& solid = solids[static_cast<std::size_t>(i)];
    keep_nearer(solid, i, origin, direction, best);
  }
  return best;
}

Eigen::Vector3d Scene::normal(const SolidHit& hit, const Eigen::Vector3d& direction) const {
  const Solid& solid = solids[static_cast<std::size_t>(hit.solid)];
  Eigen::Vector3d n = Eigen::Vector3d::Zero();
  switch (solid.shape) {
    case Shape::box:
    case Shape::room:
      n[hit.face / 2] = 1;
      break;
    case Shape::ellipsoid:
      n = hit.point.cwiseQuotient(solid.size.cwiseAbs2()).normalized();
      break;
    case Shape::capsule:
      n = hit.point;
      n.z() -= std::clamp(n.z(), -solid.size.z(), solid.size.z());
      n.normalize();
      break;
    case Shape::plate: {
      const double s = 2 * (hit.point.x() - solid.plate.outline.center.x()) / solid.plate.outline.width;
      n = Eigen::Vector3d(-4 * solid.plate.bend * s / solid.plate.outline.width, 0, 1).normalized();
      break;
    }
  }
  n = solid.T_rig_solid.R * n;
  return n.dot(direction) > 0 ? Eigen::Vector3d(-n) : n;
}

double Scene::texture(const SolidHit& hit) const {
  const Material& material = solids[static_cast<std::size_t>(hit.solid)].material;
  const Eigen::Vector3d p = hit.point / material.scale + Eigen::Vector3d::Constant(0.37 * hit.solid);
  switch (material.texture) {
    case Texture::plain:
      return 1;
    case Texture::blotches:
      return 1 + material.contrast * 0.5 *
                     (wave(p.x() + 0.3 * p.y()) * wave(p.y() - 0.4 * p.z()) + wave(0.61 * (p.z() + p.x())));
    case Texture::stripes:
      // Book spines: bands of different shades along x and y, smooth enough not to alias.
      return 1 + material.contrast * wave(p.x() + p.y()) * wave(0.31 * (p.x() + p.y()));
    case Texture::tiles: {
      // Joints a twentieth of a tile wide.
      double joint = 1;
      for (const int axis : {0, 1}) {
        const double from_joint = std::abs(p[axis] - std::round(p[axis]));
        joint = std::min(joint, smooth_step(0.01, 0.04, from_joint));
      }
      return 1 - material.contrast * (1 - joint) +
             0.2 * material.contrast * wave(0.5 * p.x()) * wave(0.5 * p.y());
    }
  }
  return 1;
}

double Scene::light(const SolidHit& hit, const Eigen::Vector3d& surface_normal) const {
  const Solid& solid = solids[static_cast<std::size_t>(hit.solid)];
  const Eigen::Vector3d to_lamp = lamp - solid.T_rig_solid * hit.point;
  // Most of a room's light has been reflected by its walls: it comes from everywhere, a little more from
  // above.
  constexpr double ambient = 0.6, from_above = 0.12, from_lamp = 0.4;
  return ambient + from_above * surface_normal.z() +
         from_lamp * std::max(0.0, surface_normal.dot(to_lamp.normalized()));
}

}  // namespace ca2
