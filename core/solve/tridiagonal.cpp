#include "core/solve/tridiagonal.h"

#include <Eigen/Householder>
#include <utility>

#include "core/types/four.h"
#include "core/types/hot_loop.h"

namespace ca2 {
namespace {

/// y = A x with the lower triangle of A, whose columns are `stride` numbers apart.
CA2_HOT_LOOP void multiply(const double* A, Eigen::Index stride, Eigen::Index size, const double* x,
                           double* y) {
  for (Eigen::Index i = 0; i < size; ++i) y[i] = 0;
  for (Eigen::Index column = 0; column < size; ++column, A += stride) {
    const double by = x[column];
    double own = A[column] * by;
    Four products = {};
    Eigen::Index i = column + 1;
    for (; i + 4 <= size; i += 4) {
      Four a, there, here;
      load(a, A + i);
      load(there, x + i);
      load(here, y + i);
      products += a * there;
      store(y + i, here + by * a);
    }
    for (; i < size; ++i) {
      own += A[i] * x[i];
      y[i] += by * A[i];
    }
    y[column] += own + sum(products);
  }
}

/// A -= v w' + w v', the lower triangle.
CA2_HOT_LOOP void subtract(const double* __restrict v, const double* __restrict w, Eigen::Index size,
                           Eigen::Index stride, double* __restrict A) {
  for (Eigen::Index column = 0; column < size; ++column, A += stride) {
    const double by_v = w[column], by_w = v[column];
    for (Eigen::Index i = column; i < size; ++i) A[i] -= v[i] * by_v + w[i] * by_w;
  }
}

}  // namespace

Tridiagonalized::Tridiagonalized(Eigen::MatrixXd S) : reflectors_(std::move(S)) {
  const Eigen::Index size = reflectors_.rows();
  sizes_.setZero(size);
  Eigen::VectorXd v(size), w(size);
  for (Eigen::Index i = 0; i + 1 < size; ++i) {
    const Eigen::Index left = size - i - 1;
    auto column = reflectors_.col(i).tail(left);
    double beta;
    column.makeHouseholderInPlace(sizes_(i), beta);
    v.head(left) = column;
    v(0) = 1;
    double* corner = &reflectors_.coeffRef(i + 1, i + 1);
    multiply(corner, size, left, v.data(), w.data());
    w.head(left) *= sizes_(i);
    w.head(left) -= 0.5 * sizes_(i) * w.head(left).dot(v.head(left)) * v.head(left);
    subtract(v.data(), w.data(), left, size, corner);
    column(0) = beta;
  }
}

void Tridiagonalized::reflect(Eigen::Index i, Eigen::Ref<Eigen::MatrixXd> x) const {
  const Eigen::Index below = reflectors_.rows() - i - 2;
  const auto v = reflectors_.col(i).tail(below);
  for (Eigen::Index column = 0; column < x.cols(); ++column) {
    const double by = sizes_(i) * (x(i + 1, column) + v.dot(x.col(column).tail(below)));
    x(i + 1, column) -= by;
    x.col(column).tail(below) -= by * v;
  }
}

void Tridiagonalized::turn(Eigen::Ref<Eigen::MatrixXd> x) const {
  for (Eigen::Index i = 0; i + 1 < reflectors_.rows(); ++i) reflect(i, x);
}

void Tridiagonalized::turn_back(Eigen::Ref<Eigen::MatrixXd> x) const {
  for (Eigen::Index i = reflectors_.rows() - 1; i-- > 0;) reflect(i, x);
}

}  // namespace ca2
