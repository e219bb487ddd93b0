/// @file How far off the given intrinsics and the ranges probably are, from what the views themselves show.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace ca2 {

/// A Gaussian prior on all deviations d (from given intrinsics, and range biases): 1/2 d'Wd - b'd.
struct NuisancePrior {
  Eigen::MatrixXd information;  ///< W
  Eigen::VectorXd pull;         ///< b
};

/// How far off the given values of a group may be.
struct NuisanceSize {
  double factor = 0;             ///< on the deviations' `sigma`; 0: they are right
  double mean_chance = 0;        ///< of this factor before the views were asked, for the mean..
  double covariance_chance = 0;  ///< ..and for the covariance
};

/// Groups that have a cause to be right together, and the chance of that cause.
struct RightTogether {
  std::vector<int> groups;
  double mean_chance = 0, covariance_chance = 0;  ///< see NuisanceSize
};

/// What the views say of the deviations that are not held, everything else marginalised: 1/2 d'Hd - h'd.
struct NuisanceEvidence {
  static constexpr int as_given = -1;  ///< a group that has exactly `sigma`, whatever the views show
  std::vector<int> index;              ///< which deviations these are..
  Eigen::Index size = 0;               ///< ..of so many
  Eigen::MatrixXd H;
  Eigen::VectorXd h;
  Eigen::VectorXd sigma;   ///< the largest standard deviations thought of, > 0
  std::vector<int> group;  ///< of each deviation: those of one group are all as far off as each other
  std::vector<std::vector<NuisanceSize>> sizes;  ///< by group, the first one right; without a common cause
  std::vector<RightTogether> right_together;
};

/// Given values may be right, or off by up to a pixel: holding right ones loosely costs up to half of the
/// answer's precision, holding wrong ones tightly ruins it. So nothing is decided: every group's deviations
/// have `sigma` times an unknown factor, of its own or with others' from a common cause. The views weigh the
/// factors by how probable these make them, and the mixture's mean and covariance of the deviations (about
/// that mean) are the answer: it comes as the Gaussian prior under which the views give just these. Few views
/// tell little about the factors, and what was thought before holds; where many find the given values right
/// to a fraction of `sigma`, they are believed; where they contradict them, the small factors vanish. Costs
/// time with the product of the groups' sizes.
NuisancePrior weigh_nuisances(const NuisanceEvidence& evidence);

}  // namespace ca2
