#include "core/solve/return_patch.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace ca2 {
namespace {

/// Rays that meet the plate further than this from the rim of the chosen part are settled, m.
constexpr double rim_reach = 0.003;
/// Second order of a plane's move along the rays, over their length: 0.03 um at 3 m.
constexpr double plane_reach = 0.0003;
/// Returns that are further outside do not come in before the board moved by half of it, m.
constexpr double near_reach = 0.2;
/// Of LiDARs, rad: 2 to 6 mrad.
constexpr double beam_width = 0.004;

double half_diagonal(const Outline& outline) {
  return 0.5 * std::hypot(outline.width, outline.height) + outline.center.norm();
}

/// Cosine of the angle at which the plate's middle is seen.
double incidence(const Pose& T_lidar_board) {
  return std::clamp(std::abs(T_lidar_board.R.col(2).dot(T_lidar_board.t)) / T_lidar_board.t.norm(), 0.05,
                    1.0);
}

}  // namespace

ReturnPatch::ReturnPatch(const LidarSight& sight) {
  returns_.reserve(sight.on_board.size() + sight.around.size());
  for (const auto* list : {&sight.on_board, &sight.around}) {
    for (const BoardReturn& here : *list) {
      const Eigen::Vector3d way = here.point.cast<double>() - Eigen::Vector3d(0, 0, here.height);
      const double range = way.norm();
      if (!(range > 0) || !std::isfinite(range)) continue;
      returns_.push_back(
          {(way / range).cast<float>(), here.height, range, 0, here.ring, 0, list == &sight.on_board});
    }
  }
  near_ = returns_.size();
  sums_.classes.resize(1);
}

double ReturnPatch::Return::predict(const Eigen::Vector3d& q) const {
  return (1 - height * q.z()) / ray.cast<double>().dot(q);
}

Eigen::Vector3d ReturnPatch::Return::at(double along) const {
  Eigen::Vector3d p = along * ray.cast<double>();
  p.z() += height;
  return p;
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
  chosen_ = settled_.size();
  for (Open& one : open_) {
    const Return& here = returns_[one.index];
    const Eigen::Vector3d ray = here.ray.cast<double>(), origin(0, 0, here.height);
    const Eigen::Vector3d hit =
        origin + (distance - normal.dot(origin)) / normal.dot(ray) * ray - T_lidar_board.t;
    one.chosen = std::abs(T_lidar_board.R.col(0).dot(hit) - outline.center.x()) <= half_width &&
                 std::abs(T_lidar_board.R.col(1).dot(hit) - outline.center.y()) <= half_height;
    chosen_ += one.chosen ? 1 : 0;
  }
  return moved;
}

void ReturnPatch::settle(const Place& place, double margin) {
  if (!place_ ||
      (near_pose_.t - place.T_lidar_board.t).norm() +
              near_pose_.difference(place.T_lidar_board).head<3>().norm() * place.T_lidar_board.t.norm() >
          0.5 * near_reach * incidence(place.T_lidar_board)) {
    near_ = returns_.size();
    near_pose_ = place.T_lidar_board;
  }
  const bool sort_out = near_ == returns_.size();
  place_ = place;
  const Pose& T = place.T_lidar_board;
  reference_ = inverse_plane(board_plane(T));
  // Where a ray meets the plate, and its place there by the plate's axes.
  const Eigen::Vector3d x_axis = T.R.col(0), y_axis = T.R.col(1);
  const double x_origin = x_axis.dot(T.t) + place.outline.center.x();
  const double y_origin = y_axis.dot(T.t) + place.outline.center.y();
  const double half_width = 0.5 * place.outline.width - margin;
  const double half_height = 0.5 * place.outline.height - margin;
  settled_.clear();
  open_.clear();
  for (std::size_t i = 0; i < near_; ++i) {
    const double predicted = returns_[i].predict(reference_);
    const Eigen::Vector3d hit = returns_[i].at(predicted);
    const double slack = std::min(half_width - std::abs(x_axis.dot(hit) - x_origin),
                                  half_height - std::abs(y_axis.dot(hit) - y_origin));
    if (sort_out && !(predicted > 0 && slack > -near_reach)) {
      // Behind the near ones.
      std::swap(returns_[i--], returns_[--near_]);
      continue;
    }
    if (!(slack > -rim_reach && predicted > 0)) continue;
    Return& here = returns_[i];
    here.predicted = predicted;
    if (slack > rim_reach && std::abs(here.range - here.predicted - place.bias) <= place.limit) {
      settled_.push_back(i);
    } else {
      open_.push_back({i, false});
    }
  }
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d corner(i & 1 ? half_width : -half_width, i & 2 ? half_height : -half_height);
    rim_[i] =
        (T * Eigen::Vector3d(place.outline.center.x() + corner.x(), place.outline.center.y() + corner.y(), 0))
            .normalized();
  }
  stale_ = true;
}

Plane ReturnPatch::fit_found(const Plane& plane, double gate, RangeSums* sums) {
  Plane fit = plane;
  for (int i = 0; i < 10; ++i) {
    settle_found(fit, gate);
    sum_up();
    fit = fit_plane(fit, gate, {}, sums);
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
  settled_.clear();
  open_.clear();
  chosen_ = 0;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  double limit = 0.6 * gate;
  for (std::size_t i = 0; i < returns_.size(); ++i) {
    Return& here = returns_[i];
    if (!here.on_board) continue;
    ++chosen_;
    middle += here.at(here.range);
    here.predicted = here.predict(reference_);
    if (std::abs(here.range - here.predicted) <= limit) {
      settled_.push_back(i);
    } else {
      open_.push_back({i, true});
    }
  }
  middle /= std::max<double>(1, static_cast<double>(chosen_));
  double radius = 0;
  for (const std::size_t i : settled_) {
    radius = std::max(radius, (returns_[i].at(returns_[i].range) - middle).squaredNorm());
  }
  const Eigen::Vector3d across = plane.normal.unitOrthogonal(), along = plane.normal.cross(across);
  for (std::size_t i = 0; i < 4; ++i) {
    rim_[i] =
        (middle + std::sqrt(radius) * ((i & 1 ? 1 : -1) * across + (i & 2 ? 1 : -1) * along)).normalized();
  }
  stale_ = true;
}

inline void ReturnPatch::add(const Return& here, CorrectionEvidence& to) const {
  // By q: (o + rho u) / (u.q), see `range_sums`.
  const double r = here.range - here.predicted;
  const double per_toward = here.predicted / (1 - here.height * reference_.z());
  const Eigen::Vector3d hit = here.at(here.predicted);
  const Eigen::Vector4d J(per_toward * hit.x(), per_toward * hit.y(), per_toward * hit.z(),
                          -static_cast<double>(here.ray.z()));
  ClassSums& one = to.classes[here.of_class];
  one.count += 1;
  one.r += r;
  one.J += J;
  to.JJ.noalias() += J.lazyProduct(J.transpose());
  to.rJ += r * J;
  to.rr += r * r;
}

void ReturnPatch::sum_up() {
  if (!stale_) return;
  CorrectionEvidence sums;
  sums.classes = std::move(sums_.classes);
  for (ClassSums& one : sums.classes) one = {one.ring, one.bin};
  spread_ = 0;
  const double bias = place_ ? place_->bias : 0;
  for (const std::size_t i : settled_) {
    const Return& here = returns_[i];
    add(here, sums);
    spread_ = std::max(spread_, std::abs(here.range - here.predicted - bias));
  }
  sums_ = std::move(sums);
  stale_ = false;
}

std::optional<int> ReturnPatch::highest_ring() const {
  int highest = -1;
  bool known = true;
  const auto look = [&](const Return& here) {
    known = known && here.ring != BoardReturn::no_ring;
    highest = std::max<int>(highest, here.ring);
  };
  for (const std::size_t i : settled_) look(returns_[i]);
  for (const Open& one : open_) {
    if (one.chosen) look(returns_[one.index]);
  }
  return known ? std::optional(highest) : std::nullopt;
}

void ReturnPatch::classify(const RangeClasses& classes, const InkMap& ink) {
  // A slot for every ring and bin, and for those not known.
  constexpr int bins = RangeClasses::bins + 1;
  std::vector<int> slots(static_cast<std::size_t>((classes.rings + 1) * bins), -1);
  sums_.classes.clear();
  const Pose T_board_lidar = place_ ? place_->T_lidar_board.inverse() : Pose{};
  for (std::size_t i = 0; i < returns_.size(); ++i) {
    Return& here = returns_[i];
    const int ring = here.ring < classes.rings ? here.ring : -1;
    int bin = -1;
    if (place_ && i < near_) {
      const double range = here.predict(reference_);
      bin = RangeClasses::bin(ink.share((T_board_lidar * here.at(range)).head<2>(), beam_width * range));
    }
    int& slot = slots[static_cast<std::size_t>((ring + 1) * bins + bin + 1)];
    if (slot < 0) {
      slot = static_cast<int>(sums_.classes.size());
      sums_.classes.push_back({ring, bin});
    }
    here.of_class = static_cast<std::uint16_t>(slot);
  }
  stale_ = true;
}

CorrectionEvidence ReturnPatch::gather(const Eigen::Vector3d& q, double bias, double gate,
                                       const RangeCorrection& correction) const {
  CorrectionEvidence all;
  const auto add_passing = [&](const Return& here) {
    const double predicted = here.predict(q);
    if (!(predicted > 0)) return;  // the ray does not meet the plane ahead
    const ClassSums& one = all.classes[here.of_class];
    const double residual = here.range - correction.at(one.ring, one.bin) - predicted - bias;
    if (std::abs(residual) <= gate) add(here, all);
  };
  // Do the settled ones pass for certain? The move of the plane along the rays is extreme at the rim (and a
  // little other for rays that do not begin in the origin).
  double off = 0;
  for (const Eigen::Vector3d& u : rim_) {
    const double move = 1.1 * (1 / u.dot(q) - 1 / u.dot(reference_));
    off = std::max(off, std::abs((place_ ? place_->bias : 0) - move - bias));
  }
  if (spread_ + off + correction.largest() + 1e-4 <= gate) {
    all = sums_;
  } else {
    all.classes = sums_.classes;
    for (ClassSums& one : all.classes) one = {one.ring, one.bin};
    for (const std::size_t i : settled_) add_passing(returns_[i]);
  }
  for (const Open& one : open_) {
    if (one.chosen) add_passing(returns_[one.index]);
  }
  return all;
}

RangeSums ReturnPatch::sums_of(const CorrectionEvidence& all, const RangeCorrection& correction) const {
  RangeSums sums;
  sums.reference = reference_;
  double r = 0, rr = all.rr;
  Eigen::Vector4d rJ = all.rJ, J = Eigen::Vector4d::Zero();
  for (const ClassSums& one : all.classes) {
    const double off = correction.at(one.ring, one.bin);
    sums.weight += one.count;
    J += one.J;
    r += one.r - off * one.count;
    rr += off * (off * one.count - 2 * one.r);
    rJ -= off * one.J;
  }
  // By q, the bias (whose derivative is -1), the slope.
  sums.H.topLeftCorner<3, 3>() = all.JJ.topLeftCorner<3, 3>();
  sums.H.block<3, 1>(0, 3) = -J.head<3>();
  sums.H.block<3, 1>(0, 4) = all.JJ.block<3, 1>(0, 3);
  sums.H(3, 3) = sums.weight;
  sums.H(3, 4) = -J(3);
  sums.H(4, 4) = all.JJ(3, 3);
  sums.H.triangularView<Eigen::StrictlyLower>() = sums.H.transpose();
  sums.gradient << rJ.head<3>(), -r, rJ(3);
  sums.cost = 0.5 * rr;
  return sums;
}

RangeSums ReturnPatch::sums(const Plane& plane, double bias, double gate,
                            const RangeCorrection& correction) const {
  return sums_of(gather(inverse_plane(plane), bias, gate, correction), correction);
}

CorrectionEvidence ReturnPatch::evidence(const Plane& plane, double gate) const {
  return gather(inverse_plane(plane), 0, gate, {});
}

Plane ReturnPatch::fit_plane(const Plane& plane, double gate, const RangeCorrection& correction,
                             RangeSums* sums) const {
  Eigen::Vector3d q = inverse_plane(plane);
  RangeSums current = sums_of(gather(q, 0, gate, correction), correction);
  for (int i = 0; i < 10; ++i) {
    // The sums are about the reference, whatever q decided on who takes part.
    const Eigen::LDLT<Eigen::Matrix3d> ldlt(current.H.topLeftCorner<3, 3>());
    const Eigen::Vector3d best = reference_ - ldlt.solve(current.gradient.head<3>());
    if (current.weight < 3 || ldlt.info() != Eigen::Success || !best.allFinite()) break;
    const double step = (best - q).norm();
    q = best;
    if (step < 1e-12 * q.norm()) break;
    current = sums_of(gather(q, 0, gate, correction), correction);
  }
  if (sums) *sums = current;
  const double norm = q.norm();
  return {-q / norm, 1 / norm};
}

}  // namespace ca2
