#include "tools/sim/plate.h"

#include <cmath>
#include <utility>

namespace ca2 {

double Plate::height(const Eigen::Vector2d& p_board) const {
  const double s = 2 * (p_board.x() - outline.center.x()) / outline.width;
  return bend * (s * s - 1.0 / 3.0);
}

bool Plate::contains(const Eigen::Vector2d& p_board, double rim) const {
  const Eigen::Vector2d offset = (p_board - outline.center).cwiseAbs();
  return offset.x() <= outline.width / 2 - rim && offset.y() <= outline.height / 2 - rim;
}

std::optional<double> Plate::intersect(const Eigen::Vector3d& origin,
                                       const Eigen::Vector3d& direction) const {
  const auto valid = [&](double t) { return t > 0 && contains((origin + t * direction).head<2>()); };
  // Height of the surface over the ray as a polynomial of the distance: a t^2 + b t + c = 0.
  const double k = 4 * bend / (outline.width * outline.width);
  const double x = origin.x() - outline.center.x();
  const double a = k * direction.x() * direction.x();
  const double b = 2 * k * x * direction.x() - direction.z();
  const double c = k * x * x - bend / 3 - origin.z();
  const double discriminant = b * b - 4 * a * c;
  if (discriminant < 0) return std::nullopt;
  // Written without cancellation, the first root serves the flat plate (a = 0) too.
  const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
  double near = q == 0 ? -1 : c / q;
  double far = a == 0 ? -1 : q / a;
  if (far > 0 && far < near) std::swap(near, far);
  if (valid(near)) return near;
  if (valid(far)) return far;
  return std::nullopt;
}

}  // namespace ca2
