#include "core/solve/view_elimination.h"

#include <cmath>
#include <limits>

#include "core/types/hot_loop.h"

namespace ca2 {
namespace {

/// The rows of `rows` become those of L^-1 rows; L: 6 x 6 by columns, with a unit diagonal.
CA2_HOT_LOOP void forward(const double* L, Eigen::Index size, double* rows) {
  for (int i = 1; i < 6; ++i) {
    double* __restrict to = rows + i * size;
    for (int k = 0; k < i; ++k) {
      const double* __restrict from = rows + k * size;
      const double factor = L[6 * k + i];
      for (Eigen::Index j = 0; j < size; ++j) to[j] -= factor * from[j];
    }
  }
}

/// S -= A'B, which is symmetric: the lower triangle only. A and B: six rows each. Small ones are not worth
/// what a general product does to begin with.
CA2_HOT_LOOP void subtract_product(const double* __restrict A, const double* __restrict B, Eigen::Index size,
                                   double* __restrict S) {
  for (Eigen::Index column = 0; column < size; ++column, S += size) {
    double b[6];
    for (int k = 0; k < 6; ++k) b[k] = B[k * size + column];
    for (Eigen::Index row = column; row < size; ++row) {
      const double* a = A + row;
      double s = S[row];
      s -= b[0] * a[0] + b[1] * a[size];
      s -= b[2] * a[2 * size] + b[3] * a[3 * size];
      s -= b[4] * a[4 * size] + b[5] * a[5 * size];
      S[row] = s;
    }
  }
}

}  // namespace

void ViewEquations::clear(Eigen::Index globals) {
  Hvv.setZero();
  Hvg.setZero(6, globals);
  gv.setZero();
}

bool Elimination::eliminate(const ViewEquations& view, double damping) {
  Matrix6d Hvv = view.Hvv;
  Hvv.diagonal() +=
      damping * view.Hvv.diagonal() + Vector6d::Constant(1e-12 * view.Hvv.diagonal().maxCoeff());
  ldlt_.compute(Hvv);
  rows_ = view.Hvg;
  right_ = view.gv;
  if (ldlt_.info() != Eigen::Success) {
    // Sums with such a view must say that they mean nothing.
    inverse_.setConstant(std::numeric_limits<double>::quiet_NaN());
    return false;
  }
  const auto& swaps = ldlt_.transpositionsP();
  const Matrix6d& L = ldlt_.matrixLDLT();
  for (Eigen::Index i = 0; i < 6; ++i) {
    if (swaps.coeff(i) == i) continue;
    rows_.row(i).swap(rows_.row(swaps.coeff(i)));
    std::swap(right_(i), right_(swaps.coeff(i)));
  }
  forward(L.data(), rows_.cols(), rows_.data());
  forward(L.data(), 1, right_.data());
  for (Eigen::Index i = 0; i < 6; ++i) {
    const double d = L(i, i);
    inverse_(i) = std::abs(d) > std::numeric_limits<double>::min() ? 1 / d : 0;
  }
  return true;
}

void Elimination::subtract_from(Eigen::MatrixXd& S, Eigen::VectorXd& r) const {
  const ViewEquations::Rows weighted = inverse_.asDiagonal() * rows_;
  subtract_product(weighted.data(), rows_.data(), rows_.cols(), S.data());
  r.noalias() -= weighted.transpose().lazyProduct(right_);
}

Vector6d Elimination::step(const Eigen::Ref<const Eigen::VectorXd>& globals) const {
  // L' x = -D^-1 (L^-1 P (gv + Hvg dg)), then P'.
  Vector6d x = right_;
  x.noalias() += rows_.lazyProduct(globals);
  x = -inverse_.cwiseProduct(x);
  ldlt_.matrixU().solveInPlace(x);
  return ldlt_.transpositionsP().transpose() * x;
}

}  // namespace ca2
