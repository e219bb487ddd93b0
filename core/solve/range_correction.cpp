#include "core/solve/range_correction.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "core/solve/range_sums.h"

namespace ca2 {
namespace {

constexpr std::size_t intensity_bins = 8;
constexpr std::size_t max_rings = 256;

/// Which unknowns there are: rings first, then intensity bins.
struct Layout {
  std::size_t rings = 0;
  std::vector<float> edges;

  std::size_t size() const { return rings + (edges.empty() ? 0 : edges.size() + 1); }
  std::size_t bin(float intensity) const {
    return static_cast<std::size_t>(std::upper_bound(edges.begin(), edges.end(), intensity) - edges.begin());
  }
};

Layout lay_out(std::span<const CorrectionPatch> patches) {
  Layout layout;
  std::vector<float> intensities;
  bool rings_known = true;
  for (const CorrectionPatch& patch : patches) {
    for (const BoardReturn& here : patch.returns) {
      if (here.ring == BoardReturn::no_ring || here.ring >= max_rings)
        rings_known = false;
      else
        layout.rings = std::max<std::size_t>(layout.rings, here.ring + 1u);
      if (std::isfinite(here.intensity)) intensities.push_back(here.intensity);
    }
  }
  if (!rings_known) layout.rings = 0;
  if (intensities.size() < 20 * intensity_bins) return layout;
  std::sort(intensities.begin(), intensities.end());
  for (std::size_t i = 1; i < intensity_bins; ++i) {
    const float edge = intensities[i * intensities.size() / intensity_bins];
    if (edge > intensities.front() && (layout.edges.empty() || edge > layout.edges.back()))
      layout.edges.push_back(edge);
  }
  return layout;
}

/// How the returns lie over the rings.
struct RingUse {
  Eigen::VectorXd counts;
  Eigen::VectorXd sine;  ///< of each ring's elevation, less their mean over the returns
};

RingUse use_of_rings(const Layout& layout, std::span<const CorrectionPatch> patches) {
  const auto rings = static_cast<Eigen::Index>(layout.rings);
  RingUse use{Eigen::VectorXd::Zero(rings), Eigen::VectorXd::Zero(rings)};
  if (rings == 0) return use;
  for (const CorrectionPatch& patch : patches) {
    for (const BoardReturn& here : patch.returns) {
      use.counts(here.ring) += 1;
      use.sine(here.ring) += static_cast<double>(here.point.z() / here.point.norm());
    }
  }
  use.sine.array() /= use.counts.array().max(1);
  use.sine.array() -= use.sine.dot(use.counts) / std::max(1.0, use.counts.sum());
  return use;
}

/// Offsets that are the same for all rings, or grow with the elevation, would move or tilt every board alike:
/// to tell them from a turn of the LiDAR is the extrinsics' business. An orthonormal basis [rings x fewer] of
/// the others.
Eigen::MatrixXd free_ring_patterns(const RingUse& use) {
  const Eigen::Index rings = use.counts.size();
  if (rings == 0) return Eigen::MatrixXd(0, 0);
  Eigen::MatrixXd held(rings, 2);
  held.col(0) = use.counts;
  held.col(1) = use.counts.cwiseProduct(use.sine);
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(held);
  const Eigen::MatrixXd Q = qr.householderQ() * Eigen::MatrixXd::Identity(rings, rings);
  return Q.rightCols(rings - qr.rank());
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

/// The most probable offsets. The priors' sizes are those under which the data is most probable (zero among
/// them): what chance explains is left alone, and a pattern that the data hardly shows is not blown up.
Probable most_probable(const Offsets& problem) {
  static constexpr double sizes[] = {0, 0.001, 0.002, 0.004, 0.008, 0.016};  // m
  const Eigen::Index rest = problem.S.rows() - problem.split;
  Probable best{Eigen::VectorXd::Zero(problem.S.rows()), 0};
  double best_evidence = 0;  // of no offsets at all
  for (const double first : sizes) {
    if (first > 0 && problem.split == 0) break;
    for (const double second : sizes) {
      if (second > 0 && rest == 0) break;
      const Eigen::Index begin = first > 0 ? 0 : problem.split;
      const Eigen::Index count = (first > 0 ? problem.split : 0) + (second > 0 ? rest : 0);
      if (count == 0) continue;
      Eigen::VectorXd size = Eigen::VectorXd::Constant(count, second);
      if (first > 0) size.head(problem.split).setConstant(first);
      const Eigen::MatrixXd scaled =
          size.asDiagonal() * problem.S.block(begin, begin, count, count) * size.asDiagonal();
      const Eigen::LLT<Eigen::MatrixXd> llt(scaled + Eigen::MatrixXd::Identity(count, count));
      if (llt.info() != Eigen::Success) continue;
      const Eigen::VectorXd g = size.cwiseProduct(problem.g.segment(begin, count));
      const Eigen::VectorXd x = llt.solve(g);
      const double log_determinant = 2 * llt.matrixLLT().diagonal().array().log().sum();
      const double evidence = 0.5 * g.dot(x) - 0.5 * log_determinant;
      // A doubling of the odds per size tried is not evidence.
      if (!(evidence > best_evidence + 3)) continue;
      best_evidence = evidence;
      best.offsets.setZero();
      best.offsets.segment(begin, count) = size.cwiseProduct(x);
      best.first_size = first;
    }
  }
  return best;
}

}  // namespace

void relate_to_white(std::vector<BoardReturn>& returns) {
  std::vector<float> intensities;
  for (const BoardReturn& here : returns) {
    if (std::isfinite(here.intensity)) intensities.push_back(here.intensity);
  }
  if (intensities.empty()) return;
  const auto decile = intensities.begin() + static_cast<std::ptrdiff_t>(9 * intensities.size() / 10);
  std::nth_element(intensities.begin(), decile, intensities.end());
  const float white = std::max(*decile, 1e-6f);
  for (BoardReturn& here : returns) here.intensity /= white;
}

double RangeCorrection::at(const BoardReturn& here) const {
  double sum = here.ring < by_ring.size() ? by_ring[here.ring] : 0;
  if (!by_intensity.empty() && std::isfinite(here.intensity)) {
    const auto bin = std::upper_bound(intensity_edges.begin(), intensity_edges.end(), here.intensity);
    sum += by_intensity[static_cast<std::size_t>(bin - intensity_edges.begin())];
  }
  return sum;
}

RangeCorrection estimate_range_correction(std::span<const CorrectionPatch> patches, double sigma,
                                          double gate) {
  const Layout layout = lay_out(patches);
  const auto size = static_cast<Eigen::Index>(layout.size());
  if (size == 0) return {};
  // Normal equations of the residuals (range - predicted) = correction + plane, the planes eliminated patch
  // by patch.
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd g = Eigen::VectorXd::Zero(size);
  Eigen::VectorXd counts = Eigen::VectorXd::Zero(size);
  double total = 0;
  for (const CorrectionPatch& patch : patches) {
    const Eigen::Vector3d q = inverse_plane(patch.plane);
    Eigen::Matrix3d Hqq = Eigen::Matrix3d::Zero();
    Eigen::Matrix<double, 3, Eigen::Dynamic> Hqa = Eigen::Matrix<double, 3, Eigen::Dynamic>::Zero(3, size);
    Eigen::Vector3d gq = Eigen::Vector3d::Zero();
    for (const BoardReturn& here : patch.returns) {
      const Eigen::Vector3d p = here.point.cast<double>();
      const double range = p.norm();
      const double inverse = p.dot(q) / range;
      if (!(inverse > 1e-6)) continue;
      const double predicted = 1 / inverse;
      const double residual = range - predicted;
      if (!(std::abs(residual) <= gate)) continue;
      const Eigen::Vector3d by_plane = -predicted * predicted / range * p;  // of the predicted range
      Hqq.noalias() += by_plane * by_plane.transpose();
      gq += residual * by_plane;
      Eigen::Index touched[2];
      int count = 0;
      if (layout.rings > 0) touched[count++] = here.ring;
      if (!layout.edges.empty() && std::isfinite(here.intensity)) {
        touched[count++] = static_cast<Eigen::Index>(layout.rings + layout.bin(here.intensity));
      }
      for (int i = 0; i < count; ++i) {
        Hqa.col(touched[i]) += by_plane;
        g(touched[i]) += residual;
        counts(touched[i]) += 1;
        for (int k = 0; k < count; ++k) H(touched[i], touched[k]) += 1;
      }
      total += 1;
    }
    const Eigen::LDLT<Eigen::Matrix3d> ldlt(Hqq);
    if (ldlt.info() != Eigen::Success || !ldlt.isPositive()) continue;
    H.noalias() -= Hqa.transpose() * ldlt.solve(Hqa);
    g.noalias() -= Hqa.transpose() * ldlt.solve(gq);
  }
  if (total < 4 * static_cast<double>(size)) return {};
  const auto rings = static_cast<Eigen::Index>(layout.rings);
  const RingUse use = use_of_rings(layout, patches);
  const Eigen::MatrixXd patterns = free_ring_patterns(use);
  Eigen::MatrixXd basis = Eigen::MatrixXd::Zero(size, patterns.cols() + size - rings);
  basis.topLeftCorner(rings, patterns.cols()) = patterns;
  basis.bottomRightCorner(size - rings, size - rings).setIdentity();
  const double information = 1 / (sigma * sigma);
  const Probable probable = most_probable(
      {information * basis.transpose() * H * basis, information * basis.transpose() * g, patterns.cols()});
  const Eigen::VectorXd offsets = basis * probable.offsets;
  if (offsets.isZero()) return {};
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
  if (rings > 0) correction.by_ring = centred(0, rings);
  if (size > rings) {
    correction.intensity_edges = layout.edges;
    correction.by_intensity = centred(rings, size - rings);
  }
  return correction;
}

}  // namespace ca2
