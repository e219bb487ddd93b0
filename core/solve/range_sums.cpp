#include "core/solve/range_sums.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace ca2 {

Eigen::Vector3d inverse_plane(const Plane& plane) {
  return -plane.normal / plane.offset;
}

double RangeSums::about_own_plane(double bias, double slope) const {
  const Vector5d here = z(reference, bias, slope);
  const Eigen::Vector3d g = (gradient + H * here).head<3>();
  return std::max(0.0, 2 * at(here) - g.dot(H.topLeftCorner<3, 3>().ldlt().solve(g)));
}

RangeSums RangeSums::with_shared_error(double shared, double sigma) const {
  if (!(shared > 0) || !(weight > 0)) return *this;
  // The residuals' derivative by q is about -rho p: its mean gives the patch's centre.
  const Eigen::Vector3d mean = -H.block<3, 1>(0, 3) / weight;
  const Eigen::Vector3d center = mean / std::sqrt(mean.norm());
  const Eigen::Vector3d normal = reference.normalized();
  const double distance = 1 / reference.norm();
  const Eigen::Vector3d across = normal.unitOrthogonal();
  const Eigen::Vector3d along = normal.cross(across);
  // q by the displacement along the normal, and by the tilts about the centre.
  Eigen::Matrix<double, 5, 3> D = Eigen::Matrix<double, 5, 3>::Zero();
  D.topRows<3>().col(0) = -normal / (distance * distance);
  D.topRows<3>().col(1) = across / distance - normal * across.dot(center) / (distance * distance);
  D.topRows<3>().col(2) = along / distance - normal * along.dot(center) / (distance * distance);
  const Eigen::Matrix3d pivot =
      D.transpose() * H * D + sigma * sigma / (shared * shared) * Eigen::Matrix3d::Identity();
  const Eigen::LLT<Eigen::Matrix3d> llt(pivot);
  const Eigen::Matrix<double, 5, 3> HD = H * D;
  const Eigen::Vector3d gD = D.transpose() * gradient;
  RangeSums sums = *this;
  sums.H -= HD * llt.solve(HD.transpose());
  sums.gradient -= HD * llt.solve(gD);
  sums.cost -= 0.5 * gD.dot(llt.solve(gD));
  return sums;
}

RangeSums range_sums(std::span<const BoardReturn> returns, const Eigen::Vector3d& reference, double bias,
                     double gate) {
  RangeSums sums;
  sums.reference = reference;
  Matrix5d& H = sums.H;
  for (const BoardReturn& here : returns) {
    const Eigen::Vector3d origin(0, 0, here.height), way = here.point.cast<double>() - origin;
    const double range = way.norm();
    const Eigen::Vector3d ray = way / range;
    const double toward = ray.dot(reference), start = 1 - origin.dot(reference);
    // Rays that do not meet the plane ahead, and points that are not finite.
    if (!(toward > 1e-6) || !(start > 0)) continue;
    const double predicted = start / toward;
    const double residual = range - predicted;
    if (!(std::abs(residual - bias) <= gate)) continue;
    Vector5d jacobian;  // of the residual by z: of the prediction by q it is -(o + rho u) / (u.q)
    jacobian << (origin + predicted * ray) / toward, -1, -ray.z();
    H.noalias() += jacobian.lazyProduct(jacobian.transpose());
    sums.gradient += residual * jacobian;
    sums.cost += 0.5 * residual * residual;
    sums.weight += 1;
  }
  return sums;
}

}  // namespace ca2
