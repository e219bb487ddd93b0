#include "core/solve/answer_covariance.h"

#include <limits>

#include "core/geometry/scaled_inverse.h"
#include "core/solve/leave_one_out.h"

namespace ca2 {

void add_covariance(JointAnswer& answer, JointProblem& problem, const JointState& state, std::size_t views) {
  const Eigen::MatrixXd information = problem.information();
  const auto covariance = scaled_inverse(information);
  if (!covariance) {
    answer.covariance = Eigen::MatrixXd::Constant(information.rows(), information.cols(), 0);
    answer.covariance.diagonal().setConstant(std::numeric_limits<double>::infinity());
    return;
  }
  answer.covariance = answer.variance_factor * *covariance;
  if (views >= 4) answer.leave_one_out = leave_one_out(problem, state, information, views);
}

}  // namespace ca2
