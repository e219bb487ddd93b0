/// @file One Levenberg-Marquardt for every least-squares problem of the project, small or with structure.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cmath>
#include <optional>
#include <stop_token>

namespace ca2 {

struct LmOptions {
  int max_iterations = 50;
  double initial_damping = 1e-4;      ///< relative to the diagonal of the normal matrix
  double gradient_tolerance = 1e-10;  ///< on the predicted decrease, relative to the cost; and on how far it
                                      ///< was wrong, where a whole Newton step was taken
  double step_tolerance = 1e-12;      ///< on the largest component of the step
  std::stop_token stop = {};          ///< no further iteration once this is asked for
  std::optional<double> cost = {};    ///< at the start, where the problem is linearised there already
};

struct LmReport {
  bool converged = false;
  int iterations = 0;
  double initial_cost = 0;
  double cost = 0;
};

/// Minimises a cost 1/2 sum rho(r^2). A Problem has
///   using State = ...;                                  a copyable value
///   double linearize(const State&)                      stores the normal equations there, returns the cost
///   std::optional<Eigen::VectorXd> step(double damping) the damped step, or nothing if it cannot be solved
///   double predicted_decrease(const Eigen::VectorXd&)   of the model just linearised (without damping)
///   State moved(const State&, const Eigen::VectorXd&)   the state after a step
///   double cost(const State&)                           the very cost that linearize returns: a step is
///   judged
///                                                       on the function whose gradient it used
/// An infinite cost marks a state outside the domain.
template <class Problem>
LmReport minimize(Problem& problem, typename Problem::State& state, const LmOptions& options = {}) {
  LmReport report;
  constexpr double whole_step = 1e-8;  // damping that leaves a step as it is
  double damping = options.initial_damping;
  double cost = options.cost ? *options.cost : problem.linearize(state);
  report.initial_cost = cost;
  for (; report.iterations < options.max_iterations && std::isfinite(cost) && !options.stop.stop_requested();
       ++report.iterations) {
    const std::optional<Eigen::VectorXd> step = problem.step(damping);
    if (step && step->allFinite()) {
      const double predicted = problem.predicted_decrease(*step);
      if (predicted <= options.gradient_tolerance * (cost + 1e-300) ||
          step->template lpNorm<Eigen::Infinity>() < options.step_tolerance) {
        // Take the last, tiny step if it does not hurt: it is what makes the answer the same to the last
        // digits from every start.
        const typename Problem::State candidate = problem.moved(state, *step);
        const double candidate_cost = problem.cost(candidate);
        if (candidate_cost <= cost) {
          state = candidate;
          cost = candidate_cost;
        }
        report.converged = true;
        break;
      }
      const typename Problem::State candidate = problem.moved(state, *step);
      const double candidate_cost = problem.cost(candidate);
      if (candidate_cost < cost) {
        const double decrease = cost - candidate_cost;
        const double ratio = decrease / predicted;
        state = candidate;
        // A model that told the decrease so well has its minimum where the cost has.
        if (damping <= whole_step && std::abs(decrease - predicted) <= options.gradient_tolerance * cost) {
          cost = candidate_cost;
          report.converged = true;
          break;
        }
        damping = ratio > 0.75 ? damping / 10 : (ratio < 0.25 ? damping * 4 : damping);
        damping = std::max(damping, 1e-12);
        cost = problem.linearize(state);
        continue;
      }
    }
    damping = std::max(damping * 10, 1e-9);
    if (damping > 1e12) break;
  }
  report.cost = cost;
  return report;
}

/// Dense normal equations H step = -g with the marquardt scaling of the diagonal; the base of small problems.
struct DenseNormalEquations {
  Eigen::MatrixXd H;
  Eigen::VectorXd g;

  void clear(Eigen::Index size) {
    H.setZero(size, size);
    g.setZero(size);
  }

  std::optional<Eigen::VectorXd> step(double damping) const {
    Eigen::MatrixXd damped = H;
    damped.diagonal() +=
        damping * H.diagonal() + Eigen::VectorXd::Constant(H.rows(), 1e-15 * H.diagonal().maxCoeff());
    const Eigen::LDLT<Eigen::MatrixXd> ldlt(damped);
    if (ldlt.info() != Eigen::Success || !ldlt.isPositive()) return std::nullopt;
    return Eigen::VectorXd(-ldlt.solve(g));
  }

  double predicted_decrease(const Eigen::VectorXd& step) const {
    return -g.dot(step) - 0.5 * step.dot(H * step);
  }
};

}  // namespace ca2
