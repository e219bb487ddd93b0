#include "core/solve/tridiagonal.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

namespace ca2 {
namespace {

TEST(Tridiagonalized, TurnedBackItIsTheMatrix) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (const Eigen::Index size : {1, 2, 3, 5, 14, 61, 126}) {
    SCOPED_TRACE(size);
    const Eigen::MatrixXd A = Eigen::MatrixXd::NullaryExpr(size, size, [&] { return normal(random); });
    const Eigen::MatrixXd S = A + A.transpose();
    Eigen::MatrixXd lower = S;
    lower.triangularView<Eigen::StrictlyUpper>().setConstant(1e9);  // not to be read
    const Tridiagonalized shape(lower);
    Eigen::MatrixXd T = shape.diagonal().asDiagonal();
    if (size > 1) T.diagonal<1>() = T.diagonal<-1>() = shape.beside();
    Eigen::MatrixXd Q = Eigen::MatrixXd::Identity(size, size);
    shape.turn_back(Q);
    const double rounding = 1e-14 * static_cast<double>(size) * S.norm();
    EXPECT_LT((Q * T * Q.transpose() - S).norm(), rounding);
    EXPECT_LT((Q.transpose() * Q - Eigen::MatrixXd::Identity(size, size)).norm(), rounding);
    Eigen::MatrixXd turned = Q;
    shape.turn(turned);
    EXPECT_LT((turned - Eigen::MatrixXd::Identity(size, size)).norm(), rounding);
  }
}

TEST(Tridiagonalized, WhatIsTridiagonalAlreadyStaysAsItIs) {
  Eigen::MatrixXd S = Eigen::MatrixXd::Zero(6, 6);
  S.diagonal() << 3, 1, 4, 1, 5, 9;
  const Tridiagonalized shape(S);
  EXPECT_TRUE(shape.diagonal().isApprox(S.diagonal(), 1e-15));
  EXPECT_TRUE(shape.beside().isZero(0));
}

}  // namespace
}  // namespace ca2
