#include "core/solve/return_patch.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

namespace ca2 {
namespace {

/// Rays that meet the plate further than this from the rim of the chosen part are settled, m.
constexpr double rim_reach = 0.004;
/// Second order of a plane's move along the rays, over their length: 1.3 um at 3 m.
constexpr double plane_reach = 0.002;
/// Of LiDARs, rad: 2 to 6 mrad.
constexpr double beam_width = 0.004;
/// Sensors have 128 at most; a file may say anything.
constexpr int most_rings = 256;

double half_diagonal(const Outline& outline) {
  return 0.5 * std::hypot(outline.width, outline.height) + outline.center.norm();
}

/// Cosine of the angle at which the plate's middle is seen.
double incidence(const Pose& T_lidar_board) {
  return std::clamp(std::abs(T_lidar_board.R.col(2).dot(T_lidar_board.t)) / T_lidar_board.t.norm(), 0.05,
                    1.0);
}

}  // namespace

ReturnPatch::ReturnPatch(const LidarSight& sight, const InkMap& ink)
    : ink_(ink), returns_(sight.on_board.size() + sight.around.size()) {
  ring_.resize(sight.on_board.size() + sight.around.size());
  std::uint16_t highest = 0;
  for (const auto* list : {&sight.on_board, &sight.around}) {
    for (const BoardReturn& here : *list) {
      const Eigen::Vector3d way = here.point.cast<double>() - Eigen::Vector3d(0, 0, here.height);
      const double range = way.norm();
      if (!(range > 0) || !std::isfinite(range)) continue;
      returns_.set(size_, way * (1 / range), here.height, range);
      ring_[size_] = here.ring < most_rings ? static_cast<std::uint16_t>(here.ring + 1) : 0;
      highest = std::max(highest, ring_[size_++]);
    }
    if (list == &sight.on_board) found_ = size_;
  }
  returns_.leave_out_from(size_);
  of_class_.assign(static_cast<std::size_t>(returns_.range.size()), 0);
  slots_.resize((highest + std::size_t{1}) * RangeClasses::bins);
}

bool ReturnPatch::holds(const Place& place) const {
  if (!place_) return false;
  if (place_->limit > 1.05 * place.limit || place_->limit < 0.7 * place.limit ||
      std::abs(place_->bias - place.bias) > 0.2 * place.limit ||
      place_->outline.center != place.outline.center) {
    return false;
  }
  const Vector6d move = place_->T_lidar_board.difference(place.T_lidar_board);
  const double radius = half_diagonal(place.outline), cosine = incidence(place.T_lidar_board);
  const double any = move.tail<3>().norm() + move.head<3>().norm() * radius;
  const double along_normal = std::abs(move(5)) + move.head<2>().norm() * radius;
  return 1.5 * any / cosine <= rim_reach && along_normal / cosine <= plane_reach;
}

bool ReturnPatch::aim(const Outline& outline, const Pose& T_lidar_board, double margin, double bias,
                      double gate) {
  const Place place{outline, T_lidar_board, bias, std::max(0.0, 0.75 * gate - 0.003)};
  const bool moved = !holds(place);
  if (moved) settle(place, margin);
  // Exactly those that are inside now.
  const Eigen::Vector3d normal = T_lidar_board.R.col(2);
  const double distance = normal.dot(T_lidar_board.t);
  const double half_width = 0.5 * outline.width - margin, half_height = 0.5 * outline.height - margin;
  chosen_ = settled_count_;
  for (Open& one : open_) {
    const Eigen::Vector3d origin(0, 0, one.height);
    const Eigen::Vector3d hit =
        origin + (distance - normal.dot(origin)) / normal.dot(one.ray) * one.ray - T_lidar_board.t;
    one.chosen = std::abs(T_lidar_board.R.col(0).dot(hit) - outline.center.x()) <= half_width &&
                 std::abs(T_lidar_board.R.col(1).dot(hit) - outline.center.y()) <= half_height;
    chosen_ += one.chosen ? 1 : 0;
  }
  return moved;
}

void ReturnPatch::settle(const Place& place, double margin) {
  place_ = place;
  reference_ = inverse_plane(board_plane(place.T_lidar_board));
  Eigen::VectorXd x, y;  // where rays meet the plate, m
  meet_plate(returns_, place.T_lidar_board, predicted_, x, y);
  const Eigen::VectorXd spots = beam_width * predicted_.cast<double>();
  Eigen::VectorXd ink(spots.size());
  ink_.shares(x.data(), y.data(), spots.data(), ink.size(), ink.data());
  const Eigen::Vector2d center = place.outline.center;
  const double half_width = 0.5 * place.outline.width - margin;
  const double half_height = 0.5 * place.outline.height - margin;
  Eigen::VectorXf open;
  spread_ = find_on_plate(
      returns_, predicted_, x, y,
      {center.x(), center.y(), half_width, half_height, rim_reach, place.bias, place.limit}, settled_, open);
  settled_count_ = 0;
  open_.clear();
  sums_.classes.clear();
  std::fill(slots_.begin(), slots_.end(), -1);
  for (std::size_t k = 0; k < size_; ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    const bool certain = settled_(i) > 0;
    if (!certain && !(open(i) > 0)) continue;
    of_class_[k] = class_of(k, RangeClasses::bin(ink(i)));
    settled_count_ += certain ? 1 : 0;
    if (!certain) open_.push_back(opened(k));
  }
  for (std::size_t i = 0; i < 4; ++i) {
    rim_[i] = (place.T_lidar_board * Eigen::Vector3d(center.x() + (i & 1 ? half_width : -half_width),
                                                     center.y() + (i & 2 ? half_height : -half_height), 0))
                  .normalized();
  }
  sum_up();
}

std::uint16_t ReturnPatch::class_of(std::size_t index, int bin) {
  int& slot = slots_[static_cast<std::size_t>(ring_[index] * RangeClasses::bins + bin)];
  if (slot < 0) {
    slot = static_cast<int>(sums_.classes.size());
    sums_.classes.push_back({ring_[index] - 1, bin});
  }
  return static_cast<std::uint16_t>(slot);
}

void ReturnPatch::sum_up() {
  if (sums_.classes.empty()) sums_.classes.resize(1);
  sum_returns(returns_, reference_, predicted_, settled_, of_class_, sums_);
  correct({});
}

void ReturnPatch::correct(const RangeCorrection& correction) {
  most_off_ = correction.largest();
  off_.clear();
  for (const ClassSums& one : sums_.classes) off_.push_back(correction.at(one.ring, one.bin));
  for (Open& one : open_) one.off = off_[one.of_class];
  corrected_ = {};
  corrected_.reference = reference_;
  double r = 0, rr = sums_.rr;
  Eigen::Vector4d rJ = sums_.rJ, J = Eigen::Vector4d::Zero();
  for (std::size_t i = 0; i < off_.size(); ++i) {
    const ClassSums& one = sums_.classes[i];
    const double off = off_[i];
    corrected_.weight += one.count;
    J += one.J;
    r += one.r - off * one.count;
    rr += off * (off * one.count - 2 * one.r);
    rJ -= off * one.J;
  }
  // By q, the bias (whose derivative is -1), the slope.
  Matrix5d& H = corrected_.H;
  H.topLeftCorner<3, 3>() = sums_.JJ.topLeftCorner<3, 3>();
  H.block<3, 1>(0, 3) = -J.head<3>();
  H.block<3, 1>(0, 4) = sums_.JJ.block<3, 1>(0, 3);
  H(3, 3) = corrected_.weight;
  H(3, 4) = -J(3);
  H(4, 4) = sums_.JJ(3, 3);
  H.triangularView<Eigen::StrictlyLower>() = H.transpose();
  corrected_.gradient << rJ.head<3>(), -r, rJ(3);
  corrected_.cost = 0.5 * rr;
}

Plane ReturnPatch::fit_found(const Plane& plane, double gate, RangeSums* sums) {
  Plane fit = plane;
  for (int i = 0; i < 10; ++i) {
    settle_found(fit, gate);
    fit = fit_plane(fit, gate, sums);
    if (!(move_to(inverse_plane(fit)) > plane_reach)) break;
  }
  return fit;
}

double ReturnPatch::move_to(const Eigen::Vector3d& q) const {
  double most = 0;
  for (const Eigen::Vector3d& u : rim_) most = std::max(most, std::abs(1 / u.dot(q) - 1 / u.dot(reference_)));
  return most;
}

void ReturnPatch::settle_found(const Plane& plane, double gate) {
  place_.reset();
  reference_ = inverse_plane(plane);
  meet_plane(returns_, reference_, predicted_);
  const Near near = find_near(returns_, found_, predicted_, 0.6 * gate, settled_);
  settled_count_ = near.count;
  spread_ = near.spread;
  std::fill(of_class_.begin(), of_class_.end(), 0);
  open_.clear();
  for (std::size_t k = 0; k < found_ && open_.size() + settled_count_ < found_; ++k) {
    if (!(settled_(static_cast<Eigen::Index>(k)) > 0)) open_.push_back(opened(k));
  }
  chosen_ = found_;
  const Eigen::Vector3d middle = 0.5 * (near.low + near.high);
  const double radius = 0.5 * (near.high - near.low).norm();
  const Eigen::Vector3d across = plane.normal.unitOrthogonal(), along = plane.normal.cross(across);
  for (std::size_t i = 0; i < 4; ++i) {
    rim_[i] = (middle + radius * ((i & 1 ? 1 : -1) * across + (i & 2 ? 1 : -1) * along)).normalized();
  }
  sums_.classes.assign(1, {});
  sum_up();
}

std::optional<int> ReturnPatch::highest_ring() const {
  int highest = -1;
  bool known = true;
  const auto look = [&](int ring) {
    known = known && ring >= 0;
    highest = std::max(highest, ring);
  };
  for (const ClassSums& one : sums_.classes) {
    if (one.count > 0) look(one.ring);
  }
  for (const Open& one : open_) {
    if (one.chosen) look(sums_.classes[one.of_class].ring);
  }
  return known ? std::optional(highest) : std::nullopt;
}

ReturnPatch::Open ReturnPatch::opened(std::size_t index) const {
  const auto i = static_cast<Eigen::Index>(index);
  Open one{of_class_[index], true, returns_.height(index), returns_.range(i), 0, returns_.ray(index), {}};
  const double predicted = predicted_(i);
  // By q: (o + rho u) / (u.q), see `range_sums`.
  const double per_toward = predicted / (1 - one.height * reference_.z());
  one.linear.r = one.range - predicted;
  one.linear.J << per_toward * (predicted * one.ray + Eigen::Vector3d(0, 0, one.height)), -one.ray.z();
  return one;
}

bool ReturnPatch::all_settled_pass(const Pass& pass) const {
  // The move of the plane along the rays is extreme at the rim (and a little other for rays that do not begin
  // in the origin).
  double off = 0;
  for (const Eigen::Vector3d& u : rim_) {
    const double move = 1.1 * (1 / u.dot(pass.q) - 1 / u.dot(reference_));
    off = std::max(off, std::abs((place_ ? place_->bias : 0) - move - pass.bias));
  }
  return spread_ + off + (pass.corrected ? most_off_ : 0) + 1e-4 <= pass.gate;
}

template <typename Add>
void ReturnPatch::each_passing(const Pass& pass, bool settled, const Add& add) const {
  const auto look = [&](const Open& here) {
    const double predicted = (1 - here.height * pass.q.z()) / here.ray.dot(pass.q);
    if (!(predicted > 0)) return;  // the ray does not meet the plane ahead
    const double residual = here.range - (pass.corrected ? here.off : 0) - predicted - pass.bias;
    if (std::abs(residual) <= pass.gate) add(here);
  };
  if (settled) {
    for (std::size_t k = 0; k < size_; ++k) {
      if (!(settled_(static_cast<Eigen::Index>(k)) > 0)) continue;
      Open one = opened(k);
      one.off = off_[one.of_class];
      look(one);
    }
  } else {
    for (const Open& one : open_) {
      if (one.chosen) look(one);
    }
  }
}

RangeSums ReturnPatch::sums_of(const Pass& pass) const {
  RangeSums sums;
  sums.reference = reference_;
  const auto add = [&](const Open& here) {
    const double r = here.linear.r - here.off;
    Vector5d J;
    J << here.linear.J.head<3>(), -1, here.linear.J(3);
    sums.H.noalias() += J.lazyProduct(J.transpose());
    sums.gradient += r * J;
    sums.cost += 0.5 * r * r;
    sums.weight += 1;
  };
  if (all_settled_pass(pass)) {
    sums = corrected_;
  } else {
    each_passing(pass, true, add);
  }
  each_passing(pass, false, add);
  return sums;
}

RangeSums ReturnPatch::sums(const Plane& plane, double bias, double gate) const {
  return sums_of({inverse_plane(plane), bias, gate});
}

CorrectionEvidence ReturnPatch::evidence(const Plane& plane, double gate) const {
  const Pass pass{inverse_plane(plane), 0, gate, false};
  CorrectionEvidence all = sums_;
  const auto add = [&](const Open& open) {
    const Linear& here = open.linear;
    ClassSums& one = all.classes[open.of_class];
    one.count += 1;
    one.r += here.r;
    one.J += here.J;
    all.JJ.noalias() += here.J.lazyProduct(here.J.transpose());
    all.rJ += here.r * here.J;
    all.rr += here.r * here.r;
  };
  if (!all_settled_pass(pass)) {
    all = {};
    for (const ClassSums& one : sums_.classes) all.classes.push_back({one.ring, one.bin});
    each_passing(pass, true, add);
  }
  each_passing(pass, false, add);
  return all;
}

Plane ReturnPatch::fit_plane(const Plane& plane, double gate, RangeSums* sums) const {
  Eigen::Vector3d q = inverse_plane(plane);
  RangeSums current = sums_of({q, 0, gate});
  for (int i = 0; i < 10; ++i) {
    // The sums are about the reference, whatever q decided on who takes part.
    const Eigen::LDLT<Eigen::Matrix3d> ldlt(current.H.topLeftCorner<3, 3>());
    const Eigen::Vector3d best = reference_ - ldlt.solve(current.gradient.head<3>());
    if (current.weight < 3 || ldlt.info() != Eigen::Success || !best.allFinite()) break;
    const double step = (best - q).norm();
    q = best;
    if (step < 1e-12 * q.norm()) break;
    current = sums_of({q, 0, gate});
  }
  if (sums) *sums = current;
  const double norm = q.norm();
  return {-q / norm, 1 / norm};
}

}  // namespace ca2
