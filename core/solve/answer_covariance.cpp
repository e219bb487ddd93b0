#include "core/solve/answer_covariance.h"

#include <limits>

#include "core/geometry/scaled_inverse.h"
#include "core/solve/leave_one_out.h"

namespace ca2 {
namespace {

/// Chi-squared with a thousand to one against chance: twice the logarithm of it.
constexpr double beyond_doubt = 13.8;

}  // namespace

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

bool rims_lie_off(const JointAnswer& answer, const JointProblem& problem, const JointState& state) {
  const auto off = [&](double value, int i) {
    return value * value > beyond_doubt * answer.covariance(i, i);
  };
  bool any = off(state.rim_depth, problem.rim_depth_index());
  for (std::size_t l = 0; l < state.dilation.size(); ++l)
    any = any || off(state.dilation[l].margin, problem.margin_index(static_cast<int>(l)));
  return any;
}

}  // namespace ca2
