#include "core/solve/leave_one_out.h"

#include <Eigen/Dense>

namespace ca2 {

Eigen::MatrixXd leave_one_out(JointProblem& problem, const JointState& state,
                              const Eigen::MatrixXd& information, std::size_t views) {
  Eigen::MatrixXd changes(static_cast<Eigen::Index>(views), information.rows());
  const Eigen::VectorXd scale = information.diagonal().cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd share;
  Eigen::VectorXd gradient;
  for (std::size_t i = 0; i < views; ++i) {
    problem.view_share(state, i, share, gradient);
    const Eigen::LDLT<Eigen::MatrixXd> without(scale.asDiagonal() * (information - share) *
                                               scale.asDiagonal());
    if (without.info() != Eigen::Success || !(without.vectorD().minCoeff() > 1e-13)) return {};
    changes.row(static_cast<Eigen::Index>(i)) =
        scale.cwiseProduct(without.solve(scale.cwiseProduct(gradient))).transpose();
  }
  return changes;
}

}  // namespace ca2
