/// The prior on intrinsics and biases that the views themselves weigh: right values are believed when many
/// views say so, wrong ones are not, and few views decide nothing.
#include "core/solve/nuisance_prior.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

namespace ca2 {
namespace {

/// Four deviations of one group and a fifth of another, measured to `precision` of their sigma.
NuisanceEvidence measured(const Eigen::VectorXd& deviation, double precision) {
  NuisanceEvidence evidence;
  evidence.index = {0, 1, 2, 3, 4};
  evidence.size = 5;
  evidence.group = {0, 0, 0, 0, 1};
  for (const double right : {0.5, 0.3})
    evidence.sizes.push_back({{0, right, 0.1}, {0.25, 0.1, 0.1}, {1, 0.9 - right, 0.8}});
  evidence.sigma = (Eigen::VectorXd(5) << 3.5, 3.5, 1, 1, 0.012).finished();
  evidence.H = (precision * evidence.sigma).cwiseAbs2().cwiseInverse().asDiagonal();
  evidence.h = evidence.H * evidence.sigma.cwiseProduct(deviation);
  return evidence;
}

struct Posterior {
  Eigen::VectorXd mean, sigma;  // in units of the evidence's sigma
};

Posterior posterior(const NuisanceEvidence& evidence) {
  const NuisancePrior prior = weigh_nuisances(evidence);
  const Eigen::LDLT<Eigen::MatrixXd> ldlt(evidence.H + prior.information);
  const Eigen::MatrixXd covariance = ldlt.solve(Eigen::MatrixXd::Identity(5, 5));
  return {ldlt.solve(evidence.h + prior.pull).cwiseQuotient(evidence.sigma),
          covariance.diagonal().cwiseSqrt().cwiseQuotient(evidence.sigma)};
}

TEST(NuisancePrior, RightValuesAreBelievedWhenManyViewsSaySo) {
  const Posterior found = posterior(measured(Eigen::VectorXd::Constant(5, 0.02), 0.02));
  for (int i = 0; i < 4; ++i) {
    EXPECT_LT(found.sigma(i), 0.012) << i;
    EXPECT_LT(std::abs(found.mean(i)), 0.01) << i;
  }
}

TEST(NuisancePrior, WrongValuesAreFoundAsIfNobodyHadGivenThem) {
  const Eigen::VectorXd deviation = (Eigen::VectorXd(5) << 0.5, -0.3, 1, 0.2, -0.9).finished();
  const Posterior found = posterior(measured(deviation, 0.02));
  EXPECT_LT((found.mean - deviation).norm(), 0.01);
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(found.sigma(i), 0.02, 0.002) << i;
}

TEST(NuisancePrior, WhatIsRightTogetherSpeaksForEachOther) {
  // The fifth was hardly measured, the others are right.
  NuisanceEvidence evidence = measured(Eigen::VectorXd::Constant(5, 0.005), 0.01);
  evidence.H(4, 4) *= 1e-4;
  evidence.h(4) = 0;
  const Posterior alone = posterior(evidence);
  EXPECT_GT(alone.sigma(4), 0.6);
  evidence.right_together = {{{0, 1}, 0.1, 0.1}};
  const Posterior together = posterior(evidence);
  EXPECT_LT(together.sigma(4), 0.7 * alone.sigma(4));
  // What is wrong tells nothing about another.
  evidence = measured(Eigen::VectorXd::Constant(5, 0.5), 0.01);
  evidence.H(4, 4) *= 1e-4;
  evidence.h(4) = 0;
  const double of_wrong = posterior(evidence).sigma(4);
  evidence.right_together = {{{0, 1}, 0.1, 0.1}};
  EXPECT_NEAR(posterior(evidence).sigma(4), of_wrong, 1e-6);
}

TEST(NuisancePrior, OneGroupMayBeRightAndTheOtherWrong) {
  const Eigen::VectorXd deviation = (Eigen::VectorXd(5) << 0, 0, 0, 0, 1).finished();
  const Posterior found = posterior(measured(deviation, 0.02));
  EXPECT_LT(found.sigma(0), 0.01);
  EXPECT_NEAR(found.mean(4), 1, 0.01);
}

TEST(NuisancePrior, NoViewsLeaveWhatWasBelievedBefore) {
  const Posterior found = posterior(measured(Eigen::VectorXd::Zero(5), 1e3));
  // Most of the chance is on 1, and little on what lies between.
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(found.sigma(i), std::sqrt(0.8 + 0.1 / 16), 0.01) << i;
}

TEST(NuisancePrior, ErrorsAreAsTheCovarianceSaysWhetherRightOrWrong) {
  std::mt19937_64 rng(3);
  std::normal_distribution<double> normal;
  for (const double off : {0.0, 1.0}) {
    for (const double precision : {0.03, 0.3}) {
      double nees = 0;
      constexpr int trials = 2000;
      for (int trial = 0; trial < trials; ++trial) {
        Eigen::VectorXd truth(5), seen(5);
        for (int i = 0; i < 5; ++i) {
          truth(i) = off * normal(rng);
          seen(i) = truth(i) + precision * normal(rng);
        }
        const NuisanceEvidence evidence = measured(seen, precision);
        const Posterior found = posterior(evidence);
        nees += (found.mean - truth).cwiseQuotient(found.sigma).squaredNorm() / (5.0 * trials);
      }
      // Right values are known better than is claimed: nobody can be sure that they are right.
      EXPECT_LT(nees, 1.4) << off << " " << precision;
      EXPECT_GT(nees, off > 0 ? 0.8 : 0.0) << precision;
    }
  }
}

}  // namespace
}  // namespace ca2
