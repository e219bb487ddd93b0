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

/// What the views say of the deviations that are not held, everything else marginalised: 1/2 d'Hd - h'd.
struct NuisanceEvidence {
  std::vector<int> index;  ///< which deviations these are..
  Eigen::Index size = 0;   ///< ..of so many
  Eigen::MatrixXd H;
  Eigen::VectorXd h;
  Eigen::VectorXd sigma;      ///< the largest standard deviations thought of, > 0
  std::vector<int> group;     ///< of each deviation: those of one group are all as far off as each other; -1:
                              ///< exactly `sigma`, whatever the views show
  std::vector<double> right;  ///< by group: the chance that its given values are right, for the mean
};

/// Given values may be right, or off by up to a pixel: holding right ones loosely costs up to half of the
/// answer's precision, holding wrong ones tightly ruins it. So nothing is decided: every group's deviations
/// have `sigma` times an unknown factor: 0 (all given values are right), 1/32 .. 1/2, or 1. The views weigh
/// the factors by how probable these make them, and the mixture's mean and covariance of the deviations are
/// the answer: it comes as the Gaussian prior under which the views give just these. The mean takes given
/// values for right with a chance that belongs to the group. The covariance (about that mean) does so with a
/// chance of 0.1: it must be true of wrong ones. Few views tell little about the factors, and `sigma` holds;
/// where many find the given values right to a fraction of it, they are believed; where they contradict them,
/// the small factors vanish.
NuisancePrior weigh_nuisances(const NuisanceEvidence& evidence);

}  // namespace ca2
