/// @file Normal equations of one view, and what is left of them without its board pose.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "core/geometry/pose.h"

namespace ca2 {

/// By the view's board pose (v) and the globals (g). What it has by the globals alone is summed over the
/// views at once: of a thousand views that would be most of the memory.
struct ViewEquations {
  using Rows = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::RowMajor>;
  Matrix6d Hvv;
  Rows Hvg;
  Vector6d gv;

  void clear(Eigen::Index globals);
};

/// One view with its board pose eliminated (Schur complement): Hvv = P'LDL'P.
class Elimination {
 public:
  /// `damping`: relative to the diagonal. False where Hvv cannot be factored; what it is subtracted from is
  /// NaN then.
  bool eliminate(const ViewEquations& view, double damping);
  /// S -= Hgv Hvv^-1 Hvg, the lower triangle only; r -= Hgv Hvv^-1 gv.
  void subtract_from(Eigen::MatrixXd& S, Eigen::VectorXd& r) const;
  /// The board pose's step that belongs to one of the globals.
  Vector6d step(const Eigen::Ref<const Eigen::VectorXd>& globals) const;

 private:
  Eigen::LDLT<Matrix6d> ldlt_;
  ViewEquations::Rows rows_;  ///< L^-1 P Hvg
  Vector6d right_;            ///< L^-1 P gv
  Vector6d inverse_;          ///< of D; 0 where D is
};

}  // namespace ca2
