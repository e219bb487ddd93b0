#include "core/solve/consensus.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <random>

#include "core/geometry/levenberg_marquardt.h"
#include "core/solve/plane_pairs.h"

namespace ca2 {
namespace {

/// How well a hypothesis agrees, as the sum of squared errors over their tolerances; over `limit`: not at
/// all.
constexpr double limit = 9;

PatchPlane seen_from_behind(const PatchPlane& patch) {
  return {{-patch.plane.normal, -patch.plane.offset}, patch.center, patch.normal_sigma};
}

/// How far the normals may disagree, rad.
double angle_sigma(const ConsensusView& view, const PatchPlane& patch, const ConsensusOptions& options) {
  return Eigen::Vector3d(options.angle_sigma, view.normal_sigma, patch.normal_sigma).norm();
}

double disagreement(const ConsensusView& view, const PatchPlane& patch, const Pose& T_camera_lidar,
                    const ConsensusOptions& options) {
  const double angle_error =
      (T_camera_lidar.R * patch.plane.normal - view.camera.normal).norm() / angle_sigma(view, patch, options);
  if (angle_error * angle_error > limit) return limit + 1;
  const Eigen::Vector3d center = T_camera_lidar * patch.center;
  const double distance_error = view.camera.distance(center) / options.distance_sigma;
  if (distance_error * distance_error > limit) return limit + 1;
  const Eigen::Vector3d offset = center - view.center;
  const Eigen::Vector3d in_plane = offset - view.camera.normal * view.camera.normal.dot(offset);
  const double center_error = 3 * in_plane.norm() / (options.board_radius + 0.05);
  return (angle_error * angle_error + distance_error * distance_error + center_error * center_error) / 3;
}

/// Least squares over normals, plane distances at the patches' centres and, weakly, the centres themselves:
/// these hold the answer where the normals alone do not determine it.
class PlanesAndCenters {
 public:
  using State = Pose;
  struct Pair {
    const ConsensusView* view;
    PatchPlane patch;
  };
  PlanesAndCenters(std::vector<Pair> pairs, const ConsensusOptions& options)
      : pairs_(std::move(pairs)), options_(options) {}

  double linearize(const State& T) {
    H_.setZero();
    g_.setZero();
    return evaluate(T, true);
  }
  double cost(const State& T) { return evaluate(T, false); }
  std::optional<Eigen::VectorXd> step(double damping) const {
    Matrix6d damped = H_;
    damped.diagonal() += damping * H_.diagonal() + Vector6d::Constant(1e-15 * H_.diagonal().maxCoeff());
    const Eigen::LDLT<Matrix6d> ldlt(damped);
    if (ldlt.info() != Eigen::Success || !ldlt.isPositive()) return std::nullopt;
    return -ldlt.solve(g_);
  }
  double predicted_decrease(const Vector6d& step) const { return -g_.dot(step) - 0.5 * step.dot(H_ * step); }
  State moved(const State& T, const Vector6d& step) const { return T.perturbed(step); }

 private:
  double evaluate(const State& T, bool with_derivatives) {
    const double distance = 1 / options_.distance_sigma;
    const double center = 1 / (0.5 * options_.board_radius);
    double cost = 0;
    for (const Pair& pair : pairs_) {
      const double angle = 1 / angle_sigma(*pair.view, pair.patch, options_);
      const Eigen::Vector3d& n = pair.view->camera.normal;
      const Eigen::Vector3d moved = T * pair.patch.center;
      Eigen::Matrix<double, 7, 1> e;
      e << angle * (T.R * pair.patch.plane.normal - n), distance * pair.view->camera.distance(moved),
          center * (moved - pair.view->center);
      cost += 0.5 * e.squaredNorm();
      if (!with_derivatives) continue;
      const Eigen::Matrix3d d_moved = -T.R * skew(pair.patch.center);
      Eigen::Matrix<double, 7, 6> J;
      J << -angle * T.R * skew(pair.patch.plane.normal), Eigen::Matrix3d::Zero(),
          distance * n.transpose() * d_moved, distance * n.transpose() * T.R, center * d_moved, center * T.R;
      H_.noalias() += J.transpose().lazyProduct(J);
      g_.noalias() += J.transpose().lazyProduct(e);
    }
    return cost;
  }

  std::vector<Pair> pairs_;
  const ConsensusOptions& options_;
  Matrix6d H_;
  Vector6d g_;
};

struct Match {
  int patch = -1;
  bool behind = false;
  double error = limit;

  bool same_as(const Match& other) const { return patch == other.patch && behind == other.behind; }
};

Match best_match(const ConsensusView& view, const Pose& T, const ConsensusOptions& options) {
  Match best;
  for (std::size_t k = 0; k < view.patches.size(); ++k) {
    for (const bool behind : {false, true}) {
      const double error =
          disagreement(view, behind ? seen_from_behind(view.patches[k]) : view.patches[k], T, options);
      if (error < best.error) best = {static_cast<int>(k), behind, error};
    }
  }
  return best;
}

/// Truncated squared error over a subset of the views: smaller is better.
double score(const std::vector<ConsensusView>& views, const std::vector<int>& subset, const Pose& T,
             const ConsensusOptions& options, double give_up) {
  double sum = 0;
  for (const int v : subset) {
    sum += best_match(views[static_cast<std::size_t>(v)], T, options).error;
    if (sum >= give_up) break;
  }
  return sum;
}

Pose refined(const std::vector<ConsensusView>& views, const std::vector<int>& subset, Pose T,
             const ConsensusOptions& options) {
  std::vector<Match> before(subset.size());
  for (int round = 0; round < 3; ++round) {
    std::vector<PlanesAndCenters::Pair> pairs;
    bool news = false;
    for (std::size_t i = 0; i < subset.size(); ++i) {
      const ConsensusView& view = views[static_cast<std::size_t>(subset[i])];
      const Match match = best_match(view, T, options);
      news = news || !match.same_as(before[i]);
      before[i] = match;
      if (match.patch < 0) continue;
      const PatchPlane& patch = view.patches[static_cast<std::size_t>(match.patch)];
      pairs.push_back({&view, match.behind ? seen_from_behind(patch) : patch});
    }
    if (pairs.size() < 3 || !news) return T;
    PlanesAndCenters problem(std::move(pairs), options);
    minimize(problem, T, {.max_iterations = 10, .gradient_tolerance = 1e-6});
  }
  return T;
}

/// A view with one of its hypotheses.
struct Choice {
  const ConsensusView* view;
  const PatchPlane* patch;
};

/// May both be the board? The angle between the normals and the distance of the centres must be the same for
/// both sensors, whatever their relative pose.
bool compatible(const Choice& a, const Choice& b, const ConsensusOptions& options) {
  const double camera_angle =
      std::acos(std::clamp(a.view->camera.normal.dot(b.view->camera.normal), -1.0, 1.0));
  const double lidar_angle =
      std::acos(std::clamp(a.patch->plane.normal.dot(b.patch->plane.normal), -1.0, 1.0));
  const double variance = 2 * options.angle_sigma * options.angle_sigma + std::pow(a.view->normal_sigma, 2) +
                          std::pow(b.view->normal_sigma, 2) + std::pow(a.patch->normal_sigma, 2) +
                          std::pow(b.patch->normal_sigma, 2);
  if (std::pow(camera_angle - lidar_angle, 2) > limit * variance) return false;
  const double camera_span = (a.view->center - b.view->center).norm();
  const double lidar_span = (a.patch->center - b.patch->center).norm();
  return std::abs(camera_span - lidar_span) <= 2 * options.board_radius + 0.1;
}

/// The pose that maps a triple of hypotheses onto the views' planes.
Pose pose_of_triple(const std::array<Choice, 3>& triple, const ConsensusOptions& options) {
  // Normals and centres together: three triangles' worth of directions leave no mirror image.
  Eigen::Matrix3d correlation = Eigen::Matrix3d::Zero();
  Eigen::Vector3d camera_mean = Eigen::Vector3d::Zero();
  Eigen::Vector3d lidar_mean = Eigen::Vector3d::Zero();
  for (const Choice& choice : triple) {
    camera_mean += choice.view->center / 3;
    lidar_mean += choice.patch->center / 3;
  }
  std::vector<PlanesAndCenters::Pair> pairs;
  for (const Choice& choice : triple) {
    correlation += choice.view->camera.normal * choice.patch->plane.normal.transpose() /
                   std::pow(options.angle_sigma, 2);
    correlation += (choice.view->center - camera_mean) * (choice.patch->center - lidar_mean).transpose() /
                   std::pow(0.5 * options.board_radius, 2);
    pairs.push_back({choice.view, *choice.patch});
  }
  Pose T;
  T.R = nearest_rotation(correlation);
  T.t = camera_mean - T.R * lidar_mean;
  PlanesAndCenters problem(std::move(pairs), options);
  minimize(problem, T, {.max_iterations = 5, .gradient_tolerance = 1e-6});
  return T;
}

/// All hypotheses of a view, the board's front first.
std::vector<PatchPlane> with_backs(const ConsensusView& view) {
  std::vector<PatchPlane> all = view.patches;
  for (const PatchPlane& patch : view.patches) all.push_back(seen_from_behind(patch));
  return all;
}

}  // namespace

Consensus match_hypotheses(const std::vector<ConsensusView>& views, const Pose& T,
                           const ConsensusOptions& options) {
  Consensus consensus;
  consensus.T_camera_lidar = T;
  for (const ConsensusView& view : views) {
    const Match match = best_match(view, T, options);
    consensus.patch.push_back(match.patch);
    consensus.agreeing += match.patch >= 0 ? 1 : 0;
  }
  return consensus;
}

std::optional<Consensus> find_consensus(const std::vector<ConsensusView>& views,
                                        const ConsensusOptions& options) {
  std::mt19937_64 rng(options.seed);
  std::vector<int> usable;
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (!views[v].patches.empty()) usable.push_back(static_cast<int>(v));
  }
  if (usable.size() < 3) return std::nullopt;
  // A sample of the views is enough to rank poses; the winner is refined on all of them.
  std::vector<int> subset = usable;
  std::shuffle(subset.begin(), subset.end(), rng);
  if (subset.size() > 60) subset.resize(60);

  std::optional<Pose> best;
  const double nothing = limit * static_cast<double>(subset.size());
  double best_score = nothing;
  double budget = options.max_hypotheses;
  // Looser tolerances for raw triples: their pose is uncertain by several times the noise of one plane.
  ConsensusOptions loose = options;
  loose.distance_sigma *= 3;
  loose.angle_sigma *= 2;
  std::uniform_int_distribution<std::size_t> pick(0, subset.size() - 1);
  for (int trial = 0; trial < budget && !options.stop.stop_requested(); ++trial) {
    std::array<std::size_t, 3> triple{pick(rng), pick(rng), pick(rng)};
    if (triple[0] == triple[1] || triple[1] == triple[2] || triple[0] == triple[2]) continue;
    std::array<const ConsensusView*, 3> chosen;
    std::array<std::vector<PatchPlane>, 3> hypotheses;
    for (std::size_t i = 0; i < 3; ++i) {
      chosen[i] = &views[static_cast<std::size_t>(subset[triple[i]])];
      hypotheses[i] = with_backs(*chosen[i]);
    }
    for (const PatchPlane& first : hypotheses[0]) {
      const Choice a{chosen[0], &first};
      for (const PatchPlane& second : hypotheses[1]) {
        const Choice b{chosen[1], &second};
        if (!compatible(a, b, options)) continue;
        for (const PatchPlane& third : hypotheses[2]) {
          const Choice c{chosen[2], &third};
          if (!compatible(a, c, options) || !compatible(b, c, options)) continue;
          const Pose T = pose_of_triple({a, b, c}, options);
          if (score(views, subset, T, loose, nothing) >= nothing - 2 * limit) continue;
          const Pose better = refined(views, subset, T, loose);
          const double value = score(views, subset, better, options, best_score);
          if (value >= best_score) continue;
          best_score = value;
          best = better;
        }
      }
    }
    // Enough triples to have met one of agreeing views only, with a chance of failure of one in a million.
    const double inliers = 1 - best_score / nothing;
    const double hit = std::pow(std::clamp(inliers, 1e-3, 0.999), 3);
    budget = std::min<double>(options.max_hypotheses, std::max(8.0, std::log(1e-6) / std::log(1 - hit)));
  }
  if (!best) return std::nullopt;
  Consensus consensus = match_hypotheses(views, refined(views, usable, *best, options), options);
  if (consensus.agreeing < 3) return std::nullopt;
  return consensus;
}

}  // namespace ca2
