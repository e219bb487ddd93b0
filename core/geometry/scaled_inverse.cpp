#include "core/geometry/scaled_inverse.h"

#include <Eigen/Eigenvalues>

namespace ca2 {

std::optional<Eigen::MatrixXd> scaled_inverse(const Eigen::MatrixXd& matrix) {
  const Eigen::VectorXd scale = matrix.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scale.asDiagonal() * matrix *
                                                             scale.asDiagonal());
  if (eigen.info() != Eigen::Success || !(eigen.eigenvalues()(0) > 1e-13)) return std::nullopt;
  return Eigen::MatrixXd(scale.asDiagonal() * eigen.eigenvectors() *
                         eigen.eigenvalues().cwiseInverse().asDiagonal() * eigen.eigenvectors().transpose() *
                         scale.asDiagonal());
}

}  // namespace ca2
