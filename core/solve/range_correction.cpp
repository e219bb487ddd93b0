#include "core/solve/range_correction.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/solve/tridiagonal.h"

namespace ca2 {
namespace {

/// How the returns lie over the rings that were seen.
struct RingUse {
  std::vector<int> rings;
  Eigen::VectorXd counts;
  Eigen::VectorXd sine;  ///< of each ring's elevation, less their mean over the returns
};

RingUse use_of_rings(const RangeClasses& classes, std::span<const CorrectionEvidence> boards) {
  Eigen::VectorXd counts = Eigen::VectorXd::Zero(classes.rings);
  Eigen::VectorXd sine = Eigen::VectorXd::Zero(classes.rings);
  for (const CorrectionEvidence& board : boards) {
    for (const ClassSums& one : board.classes) {
      if (!classes.tells(one.ring)) continue;
      counts(one.ring) += one.count;
      sine(one.ring) -= one.J(3);
    }
  }
  RingUse use;
  for (int ring = 0; ring < classes.rings; ++ring) {
    if (counts(ring) > 0) use.rings.push_back(ring);
  }
  use.counts = counts(use.rings);
  use.sine = Eigen::VectorXd(sine(use.rings)).cwiseQuotient(use.counts);
  use.sine.array() -= use.sine.dot(use.counts) / std::max(1.0, use.counts.sum());
  return use;
}

/// Offsets that are the same for all rings, or grow with the elevation, would move or tilt every board alike:
/// to tell them from a turn of the LiDAR is the extrinsics' business. The first columns of Q, as many as its
/// rank, span them; the others are free.
Eigen::ColPivHouseholderQR<Eigen::MatrixXd> held_ring_patterns(const RingUse& use) {
  Eigen::MatrixXd held(use.counts.size(), 2);
  held.col(0) = use.counts;
  held.col(1) = use.counts.cwiseProduct(use.sine);
  return Eigen::ColPivHouseholderQR<Eigen::MatrixXd>(held);
}

/// What independent offsets of unit size have as slope over the elevation: its standard deviation.
double slope_of_unit_offsets(const RingUse& use) {
  const Eigen::VectorXd weighted = use.counts.cwiseProduct(use.sine);
  const double spread = weighted.dot(use.sine);
  return spread > 0 ? weighted.norm() / spread : 0;
}

/// Unknowns x with normal equations S x = g (in units of one return's noise), of which the first `split` and
/// the others have zero-mean priors of one common size each.
struct Offsets {
  Eigen::MatrixXd S;
  Eigen::VectorXd g;
  Eigen::Index split = 0;
};

struct Probable {
  Eigen::VectorXd offsets;
  double first_size = 0;  ///< of the first prior, m
};

/// f^2 S + I with S tridiagonal, factored as LDL'.
class Tridiagonal {
 public:
  Tridiagonal(const Eigen::VectorXd& diagonal, const Eigen::VectorXd& beside, double f)
      : d_(f * f * diagonal), l_(f * f * beside) {
    for (Eigen::Index i = 0; i < d_.size(); ++i) {
      d_(i) += 1;
      if (i == 0) continue;
      const double above = l_(i - 1);
      l_(i - 1) /= d_(i - 1);
      d_(i) -= l_(i - 1) * above;
    }
  }
  double log_determinant() const { return d_.array().log().sum(); }
  Eigen::MatrixXd solve(Eigen::MatrixXd x) const {
    for (Eigen::Index i = 1; i < d_.size(); ++i) x.row(i) -= l_(i - 1) * x.row(i - 1);
    x.array().colwise() /= d_.array();
    for (Eigen::Index i = d_.size() - 1; i-- > 0;) x.row(i) -= l_(i) * x.row(i + 1);
    return x;
  }

 private:
  Eigen::VectorXd d_, l_;
};

/// The most probable offsets. The priors' sizes are those under which the data is most probable (zero among
/// them): what chance explains is left alone, and a pattern that the data hardly shows is not blown up. The
/// first unknowns are made tridiagonal once, and for every pair of sizes only the others are solved for.
Probable most_probable(const Offsets& problem) {
  static constexpr double sizes[] = {0, 0.001, 0.002, 0.004, 0.008, 0.016};  // m
  const Eigen::Index many = problem.split, few = problem.S.rows() - many;
  Eigen::MatrixXd turned(many, few + 1);  // Q' (S12, g1)
  turned << problem.S.topRightCorner(many, few), problem.g.head(many);
  const Tridiagonalized shape(problem.S.topLeftCorner(many, many));
  shape.turn(turned);
  const Eigen::MatrixXd S22 = problem.S.bottomRightCorner(few, few);
  Probable best{Eigen::VectorXd::Zero(problem.S.rows()), 0};
  double best_evidence = 0;  // of no offsets at all
  for (const double first : sizes) {
    if (first > 0 && many == 0) break;
    const Tridiagonal factor(shape.diagonal(), shape.beside(), first);
    const Eigen::MatrixXd K = first * first * turned.transpose() * factor.solve(turned);
    const double base = 0.5 * K(few, few) - 0.5 * factor.log_determinant();
    for (const double second : sizes) {
      if (second > 0 && few == 0) break;
      const Eigen::MatrixXd C =
          Eigen::MatrixXd::Identity(few, few) + second * second * (S22 - K.topLeftCorner(few, few));
      const Eigen::LLT<Eigen::MatrixXd> llt(C);
      if (llt.info() != Eigen::Success) continue;
      const Eigen::VectorXd g = second * (problem.g.tail(few) - K.topRightCorner(few, 1));
      const Eigen::VectorXd x = llt.solve(g);
      const double evidence = base + 0.5 * g.dot(x) - llt.matrixLLT().diagonal().array().log().sum();
      // A doubling of the odds per size tried is not evidence.
      if (!(evidence > best_evidence + 3)) continue;
      best_evidence = evidence;
      best.first_size = first;
      best.offsets.tail(few) = second * x;
      Eigen::MatrixXd others =
          first * first * factor.solve(turned.col(few) - turned.leftCols(few) * best.offsets.tail(few));
      shape.turn_back(others);
      best.offsets.head(many) = others;
    }
  }
  return best;
}

}  // namespace

double RangeCorrection::at(int ring, int bin) const {
  double sum = 0;
  if (ring >= 0 && static_cast<std::size_t>(ring) < by_ring.size())
    sum += by_ring[static_cast<std::size_t>(ring)];
  if (bin >= 0 && static_cast<std::size_t>(bin) < by_bin.size()) sum += by_bin[static_cast<std::size_t>(bin)];
  return sum;
}

double RangeCorrection::largest() const {
  double ring = 0, bin = 0;
  for (const double one : by_ring) ring = std::max(ring, std::abs(one));
  for (const double one : by_bin) bin = std::max(bin, std::abs(one));
  return ring + bin;
}

RangeCorrection estimate_range_correction(const RangeClasses& classes,
                                          std::span<const CorrectionEvidence> boards, double sigma) {
  const RingUse use = use_of_rings(classes, boards);
  const auto rings = static_cast<Eigen::Index>(use.rings.size());
  const Eigen::Index size = rings + RangeClasses::bins;
  std::vector<Eigen::Index> place(static_cast<std::size_t>(classes.rings), -1);
  for (std::size_t i = 0; i < use.rings.size(); ++i)
    place[static_cast<std::size_t>(use.rings[i])] = static_cast<Eigen::Index>(i);
  // Normal equations of the residuals (range - predicted) = correction + plane, the planes eliminated board
  // by board.
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd g = Eigen::VectorXd::Zero(size);
  Eigen::VectorXd counts = Eigen::VectorXd::Zero(size);
  Eigen::Matrix3Xd Hqa(3, size);
  std::vector<Eigen::Index> touched;
  double total = 0;
  for (const CorrectionEvidence& board : boards) {
    Hqa.setZero();
    touched.clear();
    for (const ClassSums& one : board.classes) {
      if (one.count == 0) continue;
      total += one.count;
      Eigen::Index at[2];
      int unknowns = 0;
      if (classes.tells(one.ring)) at[unknowns++] = place[static_cast<std::size_t>(one.ring)];
      if (one.bin >= 0) at[unknowns++] = rings + one.bin;
      for (int i = 0; i < unknowns; ++i) {
        if (Hqa.col(at[i]).isZero(0)) touched.push_back(at[i]);
        Hqa.col(at[i]) -= one.J.head<3>();
        g(at[i]) += one.r;
        counts(at[i]) += one.count;
        for (int k = 0; k < unknowns; ++k) H(at[i], at[k]) += one.count;
      }
    }
    const Eigen::LDLT<Eigen::Matrix3d> ldlt(board.JJ.topLeftCorner<3, 3>());
    if (ldlt.info() != Eigen::Success || !ldlt.isPositive()) continue;
    const Eigen::Vector3d by_plane = ldlt.solve(-board.rJ.head<3>());
    // The lower triangle.
    std::sort(touched.begin(), touched.end());
    for (std::size_t i = 0; i < touched.size(); ++i) {
      const auto here = Hqa.col(touched[i]);
      const Eigen::Vector3d solved = ldlt.solve(here);
      g(touched[i]) -= here.dot(by_plane);
      double* column = &H(0, touched[i]);
      for (std::size_t k = i; k < touched.size(); ++k) column[touched[k]] -= Hqa.col(touched[k]).dot(solved);
    }
  }
  if (total < 4 * static_cast<double>(classes.rings + RangeClasses::bins)) return {};
  H.triangularView<Eigen::StrictlyUpper>() = H.transpose();
  Offsets problem{H / (sigma * sigma), g / (sigma * sigma), rings};
  std::optional<Eigen::ColPivHouseholderQR<Eigen::MatrixXd>> held;
  Eigen::Index rank = 0;
  if (rings > 0) {
    held.emplace(held_ring_patterns(use));
    rank = held->rank();
    const auto Q = held->householderQ();
    problem.S.topRows(rings).applyOnTheLeft(Q.adjoint());
    problem.S.leftCols(rings).applyOnTheRight(Q);
    problem.g.head(rings).applyOnTheLeft(Q.adjoint());
    problem = {problem.S.bottomRightCorner(size - rank, size - rank).eval(),
               problem.g.tail(size - rank).eval(), rings - rank};
  }
  const Probable probable = most_probable(problem);
  Eigen::VectorXd offsets = Eigen::VectorXd::Zero(size);
  offsets.tail(size - rank) = probable.offsets;
  if (offsets.isZero()) return {};
  if (held) offsets.head(rings).applyOnTheLeft(held->householderQ());
  RangeCorrection correction;
  correction.slope_sigma = probable.first_size * slope_of_unit_offsets(use);
  const auto centred = [&](Eigen::Index first, Eigen::Index count) {
    const double mean = offsets.segment(first, count).dot(counts.segment(first, count)) /
                        std::max(1.0, counts.segment(first, count).sum());
    std::vector<double> values;
    for (Eigen::Index i = first; i < first + count; ++i)
      values.push_back(counts(i) > 0 ? offsets(i) - mean : 0);
    return values;
  };
  if (rings > 0) {
    const std::vector<double> seen = centred(0, rings);
    correction.by_ring.resize(static_cast<std::size_t>(classes.rings), 0);
    for (std::size_t i = 0; i < seen.size(); ++i)
      correction.by_ring[static_cast<std::size_t>(use.rings[i])] = seen[i];
  }
  if (size > rings) correction.by_bin = centred(rings, size - rings);
  return correction;
}

}  // namespace ca2
