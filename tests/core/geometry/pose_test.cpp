// The laws that SO(3) and SE(3) obey, on seeded random elements.
#include "core/geometry/pose.h"

#include <gtest/gtest.h>

#include <random>

namespace ca2 {
namespace {

Eigen::Vector3d random_vector(std::mt19937_64& rng, double scale) {
  std::normal_distribution<double> normal;
  return scale * Eigen::Vector3d(normal(rng), normal(rng), normal(rng));
}

TEST(So3, LogInvertsExpUpToPi) {
  std::mt19937_64 rng(1);
  for (const double angle : {0.0, 1e-12, 1e-6, 1e-3, 1.0, 3.0, M_PI - 1e-6, M_PI - 1e-9}) {
    for (int i = 0; i < 50; ++i) {
      const Eigen::Vector3d w = angle * random_vector(rng, 1).normalized();
      EXPECT_LT((so3_exp(so3_log(so3_exp(w))) - so3_exp(w)).norm(), 1e-12) << angle;
      EXPECT_NEAR(so3_log(so3_exp(w)).norm(), angle, 1e-8);
    }
  }
}

TEST(So3, RightJacobianIsTheDerivative) {
  std::mt19937_64 rng(2);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d w = random_vector(rng, 0.8);
    const Eigen::Vector3d d = random_vector(rng, 1e-6);
    const Eigen::Vector3d change = so3_log(so3_exp(w).transpose() * so3_exp(w + d));
    EXPECT_LT((change - so3_right_jacobian(w) * d).norm(), 1e-10);
  }
}

TEST(So3, NearestRotationIsARotationAndKeepsOne) {
  std::mt19937_64 rng(3);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Matrix3d R = so3_exp(random_vector(rng, 2));
    EXPECT_LT((nearest_rotation(R) - R).norm(), 1e-12);
    const Eigen::Matrix3d M = nearest_rotation(Eigen::Matrix3d::Random());
    EXPECT_LT((M * M.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
    EXPECT_NEAR(M.determinant(), 1, 1e-12);
  }
}

TEST(Pose, GroupLaws) {
  std::mt19937_64 rng(4);
  for (int i = 0; i < 100; ++i) {
    const Pose a{so3_exp(random_vector(rng, 2)), random_vector(rng, 3)};
    const Pose b{so3_exp(random_vector(rng, 2)), random_vector(rng, 3)};
    const Eigen::Vector3d p = random_vector(rng, 5);
    EXPECT_LT(((a * b) * p - a * (b * p)).norm(), 1e-12);
    EXPECT_LT((a.inverse() * (a * p) - p).norm(), 1e-12);
    const Pose c = Pose::from_quaternion(a.quaternion(), a.t);
    EXPECT_LT((c.R - a.R).norm(), 1e-12);
    EXPECT_GE(a.quaternion().w(), 0);
  }
}

TEST(Pose, DifferenceInvertsPerturbed) {
  std::mt19937_64 rng(5);
  for (int i = 0; i < 100; ++i) {
    const Pose a{so3_exp(random_vector(rng, 2)), random_vector(rng, 3)};
    Vector6d d;
    d << random_vector(rng, 0.5), random_vector(rng, 1);
    EXPECT_LT((a.difference(a.perturbed(d)) - d).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace ca2
