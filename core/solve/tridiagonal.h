/// @file Symmetric matrices made tridiagonal.
#pragma once

#include <Eigen/Core>

namespace ca2 {

/// S = Q T Q' with Q orthogonal and T tridiagonal, by Householder's reflections, as Eigen's class of that
/// name has it; four numbers at a time.
class Tridiagonalized {
 public:
  /// S: symmetric, of which the lower triangle is read.
  explicit Tridiagonalized(Eigen::MatrixXd S);

  Eigen::VectorXd diagonal() const { return reflectors_.diagonal(); }
  Eigen::VectorXd beside() const {
    return reflectors_.rows() > 0 ? Eigen::VectorXd(reflectors_.diagonal<-1>()) : Eigen::VectorXd();
  }
  void turn(Eigen::Ref<Eigen::MatrixXd> x) const;       ///< x becomes Q'x
  void turn_back(Eigen::Ref<Eigen::MatrixXd> x) const;  ///< x becomes Q x

 private:
  void reflect(Eigen::Index i, Eigen::Ref<Eigen::MatrixXd> x) const;

  Eigen::MatrixXd reflectors_;  ///< T, and below it by column the reflections, whose first number is 1
  Eigen::VectorXd sizes_;       ///< of the reflections: I - size v v'
};

}  // namespace ca2
