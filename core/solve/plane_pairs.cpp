#include "core/solve/plane_pairs.h"

#include <Eigen/Cholesky>
#include <Eigen/Dense>
#include <cmath>

#include "core/geometry/levenberg_marquardt.h"

namespace ca2 {

std::optional<Pose> solve_closed_form(std::span<const PlanePair> pairs, double min_spread) {
  if (pairs.size() < 3) return std::nullopt;
  Eigen::Matrix3d correlation = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d normals = Eigen::Matrix3d::Zero();
  Eigen::Vector3d distances = Eigen::Vector3d::Zero();
  for (const PlanePair& pair : pairs) {
    correlation += pair.camera.normal * pair.lidar.normal.transpose();
    normals += pair.camera.normal * pair.camera.normal.transpose();
    // n_c.(R q + t) + d_c = n_l.q + d_l for the points q of the plane, hence n_c.t = d_l - d_c.
    distances += pair.camera.normal * (pair.lidar.offset - pair.camera.offset);
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(normals);
  const double count = static_cast<double>(pairs.size());
  if (!(eigen.eigenvalues()(0) / count > min_spread * min_spread)) return std::nullopt;
  return Pose{nearest_rotation(correlation), normals.ldlt().solve(distances)};
}

namespace {

/// The published residuals in the form `minimize` takes.
class PlaneToPlane {
 public:
  using State = Pose;
  PlaneToPlane(std::span<const PlanePair> pairs, double huber) : pairs_(pairs), huber_(huber) {}

  double linearize(const State& T) {
    equations_.clear(6);
    double cost = 0;
    for (const PlanePair& pair : pairs_) {
      const Eigen::Vector4d e = residual(T, pair);
      Eigen::Matrix<double, 4, 6> J;
      const Eigen::Vector3d turned = T.R * pair.lidar.normal;
      const Eigen::Matrix3d d_turned = -T.R * skew(pair.lidar.normal);  // by the rotation
      const Eigen::Vector3d& n = pair.camera.normal;
      // p(pi_l) in the camera's frame is -n' d' with n' = R n_l, d' = d_l - n'.t.
      const double offset = pair.lidar.offset - turned.dot(T.t);
      const Eigen::RowVector3d d_offset_r = -T.t.transpose() * d_turned;
      const Eigen::RowVector3d d_offset_t = -turned.transpose() * T.R;
      J.block<1, 3>(0, 0) = offset * n.transpose() * d_turned + n.dot(turned) * d_offset_r;
      J.block<1, 3>(0, 3) = n.dot(turned) * d_offset_t;
      J.block<3, 3>(1, 0) = d_turned;
      J.block<3, 3>(1, 3).setZero();
      const double w = weight(e);
      equations_.H += w * J.transpose() * J;
      equations_.g += w * J.transpose() * e;
      cost += rho(e);
    }
    return cost;
  }
  std::optional<Eigen::VectorXd> step(double damping) const { return equations_.step(damping); }
  double predicted_decrease(const Eigen::VectorXd& step) const { return equations_.predicted_decrease(step); }
  State moved(const State& T, const Eigen::VectorXd& step) const { return T.perturbed(step); }
  double cost(const State& T) const {
    double sum = 0;
    for (const PlanePair& pair : pairs_) sum += rho(residual(T, pair));
    return sum;
  }
  const Eigen::MatrixXd& information() const { return equations_.H; }
  double squared_residuals(const State& T) const {
    double sum = 0;
    for (const PlanePair& pair : pairs_) sum += residual(T, pair).squaredNorm();
    return sum;
  }

 private:
  static Eigen::Vector4d residual(const Pose& T, const PlanePair& pair) {
    const Plane moved{T.R * pair.lidar.normal, pair.lidar.offset - (T.R * pair.lidar.normal).dot(T.t)};
    Eigen::Vector4d e;
    e << pair.camera.normal.dot(pair.camera.foot() - moved.foot()), moved.normal - pair.camera.normal;
    return e;
  }
  double weight(const Eigen::Vector4d& e) const { return e.norm() <= huber_ ? 1 : huber_ / e.norm(); }
  double rho(const Eigen::Vector4d& e) const {
    const double norm = e.norm();
    return norm <= huber_ ? 0.5 * norm * norm : huber_ * (norm - 0.5 * huber_);
  }

  std::span<const PlanePair> pairs_;
  double huber_;
  DenseNormalEquations equations_;
};

}  // namespace

PlaneToPlaneResult plane_to_plane_at(std::span<const PlanePair> pairs, const Pose& T_camera_lidar,
                                     double huber) {
  PlaneToPlane problem(pairs, huber);
  problem.linearize(T_camera_lidar);
  const double freedom = std::max(1.0, 4.0 * static_cast<double>(pairs.size()) - 6);
  return {T_camera_lidar, problem.information(), problem.squared_residuals(T_camera_lidar) / freedom};
}

std::optional<PlaneToPlaneResult> solve_plane_to_plane(std::span<const PlanePair> pairs, double huber) {
  std::optional<Pose> pose = solve_closed_form(pairs);
  if (!pose) return std::nullopt;
  PlaneToPlane problem(pairs, huber);
  if (!minimize(problem, *pose).converged) return std::nullopt;
  return plane_to_plane_at(pairs, *pose, huber);
}

}  // namespace ca2
