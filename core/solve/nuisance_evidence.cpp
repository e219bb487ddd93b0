/// JointProblem's part that weighs given intrinsics, range biases and what rims may be off by.
#include <Eigen/Cholesky>
#include <array>
#include <utility>

#include "core/geometry/levenberg_marquardt.h"
#include "core/solve/joint_problem.h"

namespace ca2 {
namespace {

/// Two views leave nothing over to say whether given values are right; from five on they may be sure of it.
constexpr std::size_t least_views_to_weigh = 3, least_views_to_trust = 5;
/// Chances that what was given is right: for the mean, and for the covariance, which must be true of wrong
/// ones too, more so where few views could contradict them or something else is not as it should be
/// (Priors::doubted). A focal length and a principal point may each be right alone (the one told by the other
/// would ruin the answer where it is not), though they mostly are together. Few LiDARs' ranges are without a
/// bias: believing it costs the planes of few views a little where it is not so. What the corners
/// contradicted a thousand to one is hardly right. Plates as thin as their print and beams that begin as
/// points are a little more likely than not. Where nothing at all is off, each of these speaks for the
/// others.
struct Right {
  double mean, doubted, believed;
  double covariance(Priors priors) const { return priors == Priors::believed ? believed : doubted; }
};
constexpr Right all_right{0.02, 0.01, 0.06}, intrinsics_right{0.15, 0.05, 0.2},
    focal_or_centre_right{0.05, 0.05, 0.08}, ranges_right{0.3, 0.3, 0.3}, rims_right{0.6, 0.2, 0.2},
    contradicted_right{0.1, 0.1, 0.1};
/// All deviations of one group are as far off as each other. NuisanceEvidence::sizes are in this order.
enum Group { focal_group, centre_group, bias_group, rim_group, distortion_group, print_group };

/// Right, as far off as thought, or something `between`, each with a chance of its own.
template <std::size_t count>
std::vector<NuisanceSize> sizes(Right right, Priors priors, const std::array<double, count>& between,
                                double chance) {
  std::vector<NuisanceSize> list{{0, right.mean, right.covariance(priors)}};
  for (const double factor : between) list.push_back({factor, chance, chance});
  list.push_back({1, 1 - right.mean - chance * count, 1 - right.covariance(priors) - chance * count});
  return list;
}

/// From right to as far off as thought in steps that lose little between them.
std::vector<NuisanceSize> stepped_sizes(Right right, Priors priors) {
  return sizes(right, priors, std::array{1. / 16, 1. / 4}, 0.05);
}
RightTogether together(std::vector<int> groups, Right right, Priors priors) {
  return {std::move(groups), right.mean, right.covariance(priors)};
}

}  // namespace

bool JointProblem::distortion_free() const {
  return intrinsics_.back() - intrinsics_.front() > 4 * cameras_;
}
Eigen::VectorXd JointProblem::deviations(const JointState& state) const {
  Eigen::VectorXd d = Eigen::VectorXd::Zero(globals_ - intrinsics_index(0));
  for (int c = 0; c < cameras_; ++c) {
    const auto i = static_cast<std::size_t>(c);
    const int free = free_intrinsics(c);
    d.segment(intrinsics_index(c) - intrinsics_index(0), free) =
        (state.cameras[i].parameters - input_.cameras[i].parameters).head(free);
  }
  if (stretch_free()) d.segment<2>(stretch_index() - intrinsics_index(0)) = state.stretch;
  for (int l = 0; l < lidars_; ++l) {
    d(bias_index(l) - intrinsics_index(0)) = state.range_bias[static_cast<std::size_t>(l)];
    d(margin_index(l) - intrinsics_index(0)) = state.dilation[static_cast<std::size_t>(l)].margin;
  }
  d(rim_depth_index() - intrinsics_index(0)) = state.rim_depth;
  return d;
}

std::optional<NuisanceEvidence> JointProblem::nuisance_evidence(const JointState& state,
                                                                Priors priors) const {
  // Held ones go with the others: their prior is no matter of belief.
  NuisanceEvidence evidence;
  const int first = intrinsics_index(0);
  evidence.size = globals_ - first;
  std::vector<int>& index = evidence.index;
  std::vector<double> sigmas;
  const auto add = [&](int i, double sigma, int group) {
    if (!(sigma > 0)) return;
    index.push_back(i);
    sigmas.push_back(sigma);
    evidence.group.push_back(group);
  };
  for (int c = 0; c < cameras_; ++c) {
    const auto i = static_cast<std::size_t>(c);
    for (int k = 0; k < free_intrinsics(c); ++k)
      add(intrinsics_index(c) - first + k, input_.prior_intrinsics[i](k),
          !input_.stated[i] ? NuisanceEvidence::as_given
          : k < 2           ? focal_group
          : k < 4           ? centre_group
                            : distortion_group);
  }
  for (int k = 0; k < (stretch_free() ? 2 : 0); ++k)
    add(stretch_index() - first + k, input_.prior_stretch, print_group);
  for (int l = 0; l < lidars_; ++l) add(bias_index(l) - first, input_.prior_bias, bias_group);
  for (int l = 0; l < lidars_; ++l) add(margin_index(l) - first, input_.rim_freedom.margin, rim_group);
  add(rim_depth_index() - first, input_.rim_freedom.depth, rim_group);
  if (index.empty()) return std::nullopt;
  evidence.sizes = {
      stepped_sizes(focal_or_centre_right, priors), stepped_sizes(focal_or_centre_right, priors),
      stepped_sizes(ranges_right, priors),          sizes(rims_right, priors, std::array{0.3}, 0.2),
      stepped_sizes(contradicted_right, priors),    stepped_sizes(contradicted_right, priors)};
  evidence.right_together = {together({focal_group, centre_group}, intrinsics_right, priors),
                             together({focal_group, centre_group, bias_group, rim_group}, all_right, priors)};
  // The marginal information in the order (others, weighed), the weighed ones' own prior taken out.
  const auto count = static_cast<Eigen::Index>(index.size());
  const Eigen::Index others = globals_ - count;
  std::vector<int> order;
  for (int i = 0; i < globals_; ++i) {
    bool weighed = false;
    for (const int k : index) weighed = weighed || i == first + k;
    if (!weighed) order.push_back(i);
  }
  for (const int k : index) order.push_back(first + k);
  const DenseNormalEquations all = marginal();
  Eigen::MatrixXd S = all.H(order, order);
  Eigen::VectorXd g = all.g(order);
  if (!S.allFinite() || !g.allFinite()) return std::nullopt;
  const Eigen::VectorXd d = deviations(state)(index);
  evidence.sigma = Eigen::Map<const Eigen::VectorXd>(sigmas.data(), count);
  const Eigen::VectorXd prior = evidence.sigma.cwiseAbs2().cwiseInverse();
  S.diagonal().tail(count) -= prior;
  g.tail(count) -= prior.cwiseProduct(d);
  // Metres, radians and the held ones side by side: a unit diagonal first.
  const Eigen::VectorXd unit = S.diagonal().head(others).cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::LLT<Eigen::MatrixXd> llt(unit.asDiagonal() * S.topLeftCorner(others, others) *
                                        unit.asDiagonal());
  if (llt.info() != Eigen::Success) return std::nullopt;
  const Eigen::MatrixXd cross = unit.asDiagonal() * S.topRightCorner(others, count);
  evidence.H = S.bottomRightCorner(count, count) - cross.transpose() * llt.solve(cross);
  evidence.h =
      evidence.H * d - g.tail(count) + cross.transpose() * llt.solve(unit.cwiseProduct(g.head(others)));
  return evidence;
}

void minimize_and_weigh(JointProblem& problem, JointInput& input, JointState& state, Priors priors) {
  // Close to the minimum from the start. The step that is left is some 1e-3 of a standard deviation, over all
  // unknowns together.
  LmOptions options{.max_iterations = 30, .initial_damping = 1e-8, .gradient_tolerance = 1e-9};
  input.nuisances.reset();
  std::optional<NuisanceEvidence> evidence;
  if (priors != Priors::as_given && input.views.size() >= least_views_to_weigh) {
    problem.linearize(state);
    evidence = problem.nuisance_evidence(state, priors);
  }
  if (evidence) {
    input.nuisances = weigh_nuisances(*evidence);
    options.cost = problem.renew_priors(state);
  }
  minimize(problem, state, options);
  if (evidence && input.views.size() < least_views_to_trust) {
    for (int& group : evidence->group) group = group == rim_group ? group : NuisanceEvidence::as_given;
    input.nuisances = weigh_nuisances(*evidence);
  }
  problem.linearize(state);
}

}  // namespace ca2
