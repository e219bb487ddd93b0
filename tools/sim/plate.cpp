#include "tools/sim/plate.h"

#include <cmath>

namespace ca2 {

double Plate::height(const Eigen::Vector2d& p_board) const {
  const double s = 2 * (p_board.x() - outline.center.x()) / outline.width;
  return bend * (s * s - 1.0 / 3.0);
}

bool Plate::contains(const Eigen::Vector2d& p_board, double rim) const {
  const Eigen::Vector2d offset = (p_board - outline.center).cwiseAbs();
  return offset.x() <= outline.width / 2 - rim && offset.y() <= outline.height / 2 - rim;
}

std::optional<double> Plate::meet(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const {
  // Height of the surface over the ray as a polynomial of the distance: a t^2 + b t + c = 0.
  const double k = 4 * bend / (outline.width * outline.width);
  const double x = origin.x() - outline.center.x();
  const double a = k * direction.x() * direction.x();
  const double b = 2 * k * x * direction.x() - direction.z();
  const double c = k * x * x - bend / 3 - origin.z();
  const double discriminant = b * b - 4 * a * c;
  if (discriminant < 0) return std::nullopt;
  // The root that goes over to the flat plate's, written without cancellation; the other one is where the
  // parabola has turned back far off the plate.
  const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
  if (q == 0) return std::nullopt;
  return c / q;
}

std::optional<double> Plate::intersect(const Eigen::Vector3d& origin,
                                       const Eigen::Vector3d& direction) const {
  const std::optional<double> t = meet(origin, direction);
  if (!t || *t <= 0 || !contains((origin + *t * direction).head<2>())) return std::nullopt;
  return t;
}

}  // namespace ca2
