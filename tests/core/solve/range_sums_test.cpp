/// The sums stand for the returns: the same cost, the same derivatives, and shared errors taken out exactly.
#include "core/solve/range_sums.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <limits>
#include <random>
#include <vector>

namespace ca2 {
namespace {

const Eigen::Vector3d normal = Eigen::Vector3d(-0.8, 0.3, 0.2).normalized();
const Plane plane{normal, 2.5};

Eigen::Vector3d origin_of(const BoardReturn& here) {
  return {0, 0, here.height};
}

/// A patch of `count` returns about the plane's foot, off by Gaussian noise along their rays, which begin
/// between 50 mm below and 50 mm above the origin.
std::vector<BoardReturn> patch(int count, double sigma, std::mt19937_64& rng) {
  std::normal_distribution<double> noise(0, sigma);
  std::uniform_real_distribution<double> place(-0.4, 0.4);
  const Eigen::Vector3d across = normal.unitOrthogonal();
  const Eigen::Vector3d along = normal.cross(across);
  std::vector<BoardReturn> returns;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d p = plane.foot() + (place(rng) + 0.3) * across + place(rng) * along;
    BoardReturn& here = returns.emplace_back();
    here.height = static_cast<float>(0.05 * std::sin(i));
    here.point = (p + noise(rng) * (p - origin_of(here)).normalized()).cast<float>();
  }
  return returns;
}

/// 1/2 sum of (range - bias - slope sine - predicted)^2, without any sums.
double plain_cost(const std::vector<BoardReturn>& returns, const Eigen::Vector3d& q, double bias,
                  double slope = 0) {
  double cost = 0;
  for (const BoardReturn& here : returns) {
    const Eigen::Vector3d way = here.point.cast<double>() - origin_of(here);
    const double predicted = way.norm() * (1 - origin_of(here).dot(q)) / way.dot(q);
    const double residual = way.norm() - bias - slope * way.z() / way.norm() - predicted;
    cost += 0.5 * residual * residual;
  }
  return cost;
}

TEST(RangeSums, CostAndGradientAreThoseOfTheReturns) {
  std::mt19937_64 rng(1);
  const auto returns = patch(200, 0.01, rng);
  const Eigen::Vector3d q = inverse_plane({normal, 2.503});
  const RangeSums sums = range_sums(returns, q, 0, 1);
  EXPECT_EQ(sums.weight, 200);
  EXPECT_NEAR(sums.cost, plain_cost(returns, q, 0), 1e-12);
  const double h = 1e-6;
  for (int k = 0; k < 5; ++k) {
    const Vector5d z = h * Vector5d::Unit(k);
    const double numeric = (plain_cost(returns, q + z.head<3>(), z(3), z(4)) -
                            plain_cost(returns, q - z.head<3>(), -z(3), -z(4))) /
                           (2 * h);
    EXPECT_NEAR(sums.gradient(k), numeric, 1e-6 * (1 + std::abs(numeric))) << k;
  }
}

TEST(RangeSums, HessianIsThatOfNoiseFreeReturns) {
  std::mt19937_64 rng(2);
  const auto returns = patch(100, 0, rng);
  const Eigen::Vector3d q = inverse_plane(plane);
  const RangeSums sums = range_sums(returns, q, 0, 1);
  const double h = 1e-4;
  for (int i = 0; i < 5; ++i) {
    for (int k = 0; k < 5; ++k) {
      const auto cost = [&](double a, double b) {
        const Vector5d z = a * Vector5d::Unit(i) + b * Vector5d::Unit(k);
        return plain_cost(returns, q + z.head<3>(), z(3), z(4));
      };
      const double numeric = (cost(h, h) - cost(h, -h) - cost(-h, h) + cost(-h, -h)) / (4 * h * h);
      EXPECT_NEAR(sums.H(i, k), numeric, 1e-4 * sums.H.norm()) << i << k;
    }
  }
}

TEST(RangeSums, ReturnsBeyondTheGateDoNotCount) {
  std::mt19937_64 rng(3);
  auto returns = patch(50, 0, rng);
  returns[7].point *= 1.1f;
  returns[8].point.x() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(range_sums(returns, inverse_plane(plane), 0, 0.05).weight, 48);
}

/// The information that is left must be that of the noise plus the shared error: in covariances of the fitted
/// plane they simply add.
TEST(RangeSums, SharedErrorAddsToThePlanesCovariance) {
  std::mt19937_64 rng(5);
  const double sigma = 0.01, shared = 0.004;
  const auto returns = patch(400, 0, rng);
  const RangeSums sums = range_sums(returns, inverse_plane(plane), 0, 1);
  const Eigen::Matrix3d noise = sigma * sigma * Eigen::Matrix3d(sums.H.topLeftCorner<3, 3>()).inverse();
  const RangeSums with = sums.with_shared_error(shared, sigma);
  const Eigen::Matrix3d both = sigma * sigma * Eigen::Matrix3d(with.H.topLeftCorner<3, 3>()).inverse();
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (const BoardReturn& here : returns) center += here.point.cast<double>() / 400;
  // Moves the plane by `shared` at the centre and turns it by `shared` radians about both axes there.
  Eigen::Matrix3d expected = noise;
  const Eigen::Vector3d across = normal.unitOrthogonal();
  const auto add = [&](const Eigen::Vector3d& turned, double offset) {
    const double h = 1e-5;
    const Eigen::Vector3d n = (normal + h * turned).normalized();
    const double d = -n.dot(center) + h * offset;
    const Eigen::Vector3d change = (inverse_plane({n, d}) - inverse_plane({normal, -normal.dot(center)})) / h;
    expected += shared * shared * change * change.transpose();
  };
  add(Eigen::Vector3d::Zero(), 1);
  add(across, 0);
  add(normal.cross(across), 0);
  EXPECT_LT((both - expected).norm(), 0.05 * expected.norm());
  EXPECT_GT((both - noise).norm(), 0.5 * both.norm());
}

TEST(RangeSums, NoSharedErrorChangesNothing) {
  std::mt19937_64 rng(6);
  const RangeSums sums = range_sums(patch(50, 0.01, rng), inverse_plane(plane), 0, 1);
  EXPECT_EQ(sums.with_shared_error(0, 0.01).H, sums.H);
}

}  // namespace
}  // namespace ca2
