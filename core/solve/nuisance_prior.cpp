#include "core/solve/nuisance_prior.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace ca2 {
namespace {

/// Nothing is known better than to this share of its `sigma`: keeps the mixture's covariance regular.
constexpr double least_sigma = 1e-4;

/// The deviations in units of their `sigma` under one choice of factors.
struct Component {
  double log_mean_weight = 0, log_covariance_weight = 0;
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
};

Component component_of(const Eigen::MatrixXd& H, const Eigen::VectorXd& h, const Eigen::VectorXd& size) {
  const Eigen::Index count = h.size();
  const Eigen::LLT<Eigen::MatrixXd> llt(size.asDiagonal() * H * size.asDiagonal() +
                                        Eigen::MatrixXd::Identity(count, count));
  const Eigen::VectorXd g = size.cwiseProduct(h);
  const Eigen::VectorXd x = llt.solve(g);
  const double log_determinant = 2 * llt.matrixLLT().diagonal().array().log().sum();
  const double log_likelihood = 0.5 * g.dot(x) - 0.5 * log_determinant;
  return {log_likelihood, log_likelihood, size.cwiseProduct(x),
          size.asDiagonal() * llt.solve(Eigen::MatrixXd::Identity(count, count)) * size.asDiagonal()};
}

/// Of one size per group: the chance that the groups have these, in any way that it may come about.
double chance_of(const NuisanceEvidence& evidence, const std::vector<std::size_t>& groups,
                 const std::vector<std::size_t>& choice, double NuisanceSize::*chance,
                 double RightTogether::*together) {
  double total = 0, alone = 1;
  const auto add = [&](double cause, const std::vector<int>& right) {
    double product = cause;
    for (const std::size_t g : groups) {
      if (std::ranges::count(right, static_cast<int>(g)) == 0)
        product *= evidence.sizes[g][choice[g]].*chance;
      else if (choice[g] != 0)
        return;
    }
    total += product;
  };
  for (const RightTogether& cause : evidence.right_together) {
    add(cause.*together, cause.groups);
    alone -= cause.*together;
  }
  add(alone, {});
  return total;
}

/// Every combination of the groups' sizes.
std::vector<Component> components_of(const NuisanceEvidence& evidence, const Eigen::MatrixXd& H,
                                     const Eigen::VectorXd& h) {
  std::vector<std::size_t> groups;  // that have deviations
  for (std::size_t g = 0; g < evidence.sizes.size(); ++g) {
    if (std::ranges::count(evidence.group, static_cast<int>(g)) > 0) groups.push_back(g);
  }
  std::vector<Component> list;
  std::vector<std::size_t> choice(evidence.sizes.size(), 0);
  for (bool more = true; more;) {
    Eigen::VectorXd size = Eigen::VectorXd::Ones(h.size());
    for (Eigen::Index i = 0; i < size.size(); ++i) {
      const int group = evidence.group[static_cast<std::size_t>(i)];
      if (group < 0) continue;
      const auto g = static_cast<std::size_t>(group);
      size(i) = evidence.sizes[g][choice[g]].factor;
    }
    Component component = component_of(H, h, size);
    component.log_mean_weight += std::log(
        chance_of(evidence, groups, choice, &NuisanceSize::mean_chance, &RightTogether::mean_chance));
    component.log_covariance_weight += std::log(chance_of(
        evidence, groups, choice, &NuisanceSize::covariance_chance, &RightTogether::covariance_chance));
    list.push_back(std::move(component));
    more = false;
    for (const std::size_t g : groups) {
      more = ++choice[g] < evidence.sizes[g].size();
      if (more) break;
      choice[g] = 0;
    }
  }
  return list;
}

/// Relative to their sum.
std::vector<double> weights_of(const std::vector<Component>& components, double Component::*logarithm) {
  double largest = -std::numeric_limits<double>::infinity(), total = 0;
  for (const Component& c : components) largest = std::max(largest, c.*logarithm);
  std::vector<double> weights;
  for (const Component& c : components) total += weights.emplace_back(std::exp(c.*logarithm - largest));
  for (double& weight : weights) weight /= total;
  return weights;
}

}  // namespace

NuisancePrior weigh_nuisances(const NuisanceEvidence& evidence) {
  const Eigen::Index count = evidence.h.size();
  const auto unit = evidence.sigma.asDiagonal();
  const Eigen::MatrixXd H = unit * evidence.H * unit;
  const Eigen::VectorXd h = unit * evidence.h;
  const std::vector<Component> components = components_of(evidence, H, h);
  const std::vector<double> weights = weights_of(components, &Component::log_mean_weight);
  const std::vector<double> spread_weights = weights_of(components, &Component::log_covariance_weight);
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(count);
  for (std::size_t i = 0; i < components.size(); ++i) mean += weights[i] * components[i].mean;
  Eigen::MatrixXd covariance = least_sigma * least_sigma * Eigen::MatrixXd::Identity(count, count);
  for (std::size_t i = 0; i < components.size(); ++i) {
    const Eigen::VectorXd off = components[i].mean - mean;
    covariance += spread_weights[i] * (components[i].covariance + off * off.transpose());
  }
  const Eigen::MatrixXd posterior = covariance.llt().solve(Eigen::MatrixXd::Identity(count, count));
  // A mixture of two minds may be less certain than the views alone: no prior does that.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(posterior - H);
  const Eigen::VectorXd kept = eigen.eigenvalues().cwiseMax(1e-6);
  const Eigen::MatrixXd W = eigen.eigenvectors() * kept.asDiagonal() * eigen.eigenvectors().transpose();
  const Eigen::VectorXd b = W * mean + (H * mean - h);
  const auto per_unit = evidence.sigma.cwiseInverse().asDiagonal();
  NuisancePrior prior{Eigen::MatrixXd::Zero(evidence.size, evidence.size),
                      Eigen::VectorXd::Zero(evidence.size)};
  prior.information(evidence.index, evidence.index) = per_unit * W * per_unit;
  prior.pull(evidence.index) = per_unit * b;
  return prior;
}

}  // namespace ca2
