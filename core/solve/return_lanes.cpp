#include "core/solve/return_lanes.h"

#include <algorithm>
#include <limits>

#include "core/geometry/plane.h"
#include "core/solve/range_sums.h"
#include "core/types/four.h"
#include "core/types/hot_loop.h"

namespace ca2 {
namespace {

/// The arrays' places.
struct Rays {
  explicit Rays(const ReturnArrays& returns)
      : x(returns.rays.data()),
        y(x + returns.rays.rows()),
        z(y + returns.rays.rows()),
        height(z + returns.rays.rows()),
        range(returns.range.data()),
        size(returns.range.size()) {}
  const float *x, *y, *z, *height, *range;
  Eigen::Index size;
};

/// What is summed: r is the residual, J its derivative by the plane's inverse and the range slope.
enum Term : std::size_t { n, r, J0, J1, J2, J3, class_terms };

CA2_HOT_LOOP void meet(const Rays& rays, const Eigen::Vector3d& q, float* along) {
  for (Eigen::Index i = 0; i < rays.size; i += ReturnArrays::lanes) {
    Four x, y, z, height;
    load(x, rays.x + i);
    load(y, rays.y + i);
    load(z, rays.z + i);
    load(height, rays.height + i);
    store(along + i, (1 - height * q[2]) / (x * q[0] + y * q[1] + z * q[2]));
  }
}

CA2_HOT_LOOP void place(const Rays& rays, const float* along, const Eigen::Vector3d& axis, double origin,
                        double* places) {
  for (Eigen::Index i = 0; i < rays.size; i += ReturnArrays::lanes) {
    Four x, y, z, height, to;
    load(x, rays.x + i);
    load(y, rays.y + i);
    load(z, rays.z + i);
    load(height, rays.height + i);
    load(to, along + i);
    store(places + i, to * (x * axis[0] + y * axis[1] + z * axis[2]) + height * axis[2] - origin);
  }
}

CA2_HOT_LOOP double mark_on_plate(const Rays& rays, const float* along, const double* x, const double* y,
                                  const PlatePart& part, float* certain, float* open) {
  const Four none = {}, one = none + 1;
  Four spread = none;
  for (Eigen::Index i = 0; i < rays.size; i += ReturnArrays::lanes) {
    Four at_x, at_y, range, to;
    load(at_x, x + i);
    load(at_y, y + i);
    load(range, rays.range + i);
    load(to, along + i);
    at_x -= part.x;
    at_y -= part.y;
    const Four beside = part.half_width - (at_x < 0 ? -at_x : at_x);
    const Four above = part.half_height - (at_y < 0 ? -at_y : at_y);
    const Four inside = beside < above ? beside : above;
    const Four residual = range - to - part.bias;
    const Four off = residual < 0 ? -residual : residual;
    const Four on = inside > -part.rim ? (to > 0 ? one : none) : none;
    const Four in = inside > part.rim ? (off <= part.limit ? on : none) : none;
    store(certain + i, in);
    store(open + i, on - in);
    spread = in > 0 ? (spread < off ? off : spread) : spread;
  }
  double most = 0;
  for (int lane = 0; lane < ReturnArrays::lanes; ++lane) most = std::max(most, spread[lane]);
  return most;
}

CA2_HOT_LOOP void mark_near(const Rays& rays, Eigen::Index count, const float* along, double limit,
                            float* taken, Near& near) {
  const Four none = {}, one = none + 1, infinite = none + std::numeric_limits<double>::infinity();
  const Four end = none + static_cast<double>(count);
  Four low[3] = {infinite, infinite, infinite}, high[3] = {-infinite, -infinite, -infinite};
  Four spread = none, taken_in_all = none, index = {0, 1, 2, 3};
  for (Eigen::Index i = 0; i < rays.size; i += ReturnArrays::lanes, index += 4) {
    Four ray[3], range, to;
    load(ray[0], rays.x + i);
    load(ray[1], rays.y + i);
    load(ray[2], rays.z + i);
    load(range, rays.range + i);
    load(to, along + i);
    const Four residual = range - to;
    const Four off = residual < 0 ? -residual : residual;
    const Four in = index < end ? (off <= limit ? one : none) : none;
    store(taken + i, in);
    taken_in_all += in;
    spread = in > 0 ? (spread < off ? off : spread) : spread;
    for (int k = 0; k < 3; ++k) {
      const Four place = range * ray[k];
      low[k] = in > 0 ? (place < low[k] ? place : low[k]) : low[k];
      high[k] = in > 0 ? (high[k] < place ? place : high[k]) : high[k];
    }
  }
  near.count = static_cast<std::size_t>(sum(taken_in_all));
  for (int lane = 0; lane < ReturnArrays::lanes; ++lane) {
    near.spread = std::max(near.spread, spread[lane]);
    for (int k = 0; k < 3; ++k) {
      near.low[k] = lane == 0 ? low[k][0] : std::min(near.low[k], low[k][lane]);
      near.high[k] = lane == 0 ? high[k][0] : std::max(near.high[k], high[k][lane]);
    }
  }
}

CA2_HOT_LOOP void add_up(const Rays& rays, double q_z, const float* along, const float* taken,
                         const std::uint16_t* of_class, CorrectionEvidence& sums) {
  const bool one_class = sums.classes.size() == 1;
  Four JJ[10] = {}, rJ[4] = {}, rr = {}, all[class_terms] = {};
  for (Eigen::Index i = 0; i < rays.size; i += ReturnArrays::lanes) {
    Four x, y, z, height, range, to, in;
    load(x, rays.x + i);
    load(y, rays.y + i);
    load(z, rays.z + i);
    load(height, rays.height + i);
    load(range, rays.range + i);
    load(to, along + i);
    load(in, taken + i);
    to = in > 0 ? to : Four{};
    // By q: (o + rho u) / (u.q), see `range_sums`.
    const Four per_toward = in * to / (1 - height * q_z);
    const Four one[class_terms] = {in,
                                   in * (range - to),
                                   per_toward * (to * x),
                                   per_toward * (to * y),
                                   per_toward * (to * z + height),
                                   -in * z};
    const Four* const J = one + J0;
    Four* here = JJ;
    for (int row = 0; row < 4; ++row) {
      for (int column = row; column < 4; ++column) *here++ += J[row] * J[column];
      rJ[row] += one[r] * J[row];
    }
    rr += one[r] * one[r];
    if (one_class) {
      for (std::size_t term = 0; term < class_terms; ++term) all[term] += one[term];
      continue;
    }
    for (Eigen::Index k = 0; k < ReturnArrays::lanes; ++k) {
      ClassSums& its = sums.classes[of_class[i + k]];
      its.count += one[n][k];
      its.r += one[r][k];
      for (int row = 0; row < 4; ++row) its.J[row] += J[row][k];
    }
  }
  if (one_class) {
    ClassSums& its = sums.classes.front();
    its.count = sum(all[n]);
    its.r = sum(all[r]);
    for (int row = 0; row < 4; ++row) its.J[row] = sum(all[J0 + static_cast<std::size_t>(row)]);
  }
  const Four* here = JJ;
  for (int row = 0; row < 4; ++row) {
    for (int column = row; column < 4; ++column) sums.JJ(row, column) = sums.JJ(column, row) = sum(*here++);
    sums.rJ(row) = sum(rJ[row]);
  }
  sums.rr = sum(rr);
}

}  // namespace

ReturnArrays::ReturnArrays(std::size_t size) {
  const Eigen::Index padded = (static_cast<Eigen::Index>(size) + lanes - 1) / lanes * lanes;
  rays.resize(padded, 4);
  range.resize(padded);
}

void ReturnArrays::leave_out_from(std::size_t size) {
  const Eigen::Index rest = range.size() - static_cast<Eigen::Index>(size);
  rays.bottomRows(rest).setZero();
  range.tail(rest).setZero();
}

void meet_plate(const ReturnArrays& returns, const Pose& T_lidar_board, Eigen::VectorXf& along,
                Eigen::VectorXd& x, Eigen::VectorXd& y) {
  const Rays rays(returns);
  meet_plane(returns, inverse_plane(board_plane(T_lidar_board)), along);
  x.resize(rays.size);
  y.resize(rays.size);
  const Eigen::Vector3d x_axis = T_lidar_board.R.col(0), y_axis = T_lidar_board.R.col(1);
  place(rays, along.data(), x_axis, x_axis.dot(T_lidar_board.t), x.data());
  place(rays, along.data(), y_axis, y_axis.dot(T_lidar_board.t), y.data());
}

void meet_plane(const ReturnArrays& returns, const Eigen::Vector3d& q, Eigen::VectorXf& along) {
  const Rays rays(returns);
  along.resize(rays.size);
  meet(rays, q, along.data());
}

double find_on_plate(const ReturnArrays& returns, const Eigen::VectorXf& along, const Eigen::VectorXd& x,
                     const Eigen::VectorXd& y, const PlatePart& part, Eigen::VectorXf& certain,
                     Eigen::VectorXf& open) {
  const Rays rays(returns);
  certain.resize(rays.size);
  open.resize(rays.size);
  return mark_on_plate(rays, along.data(), x.data(), y.data(), part, certain.data(), open.data());
}

Near find_near(const ReturnArrays& returns, std::size_t count, const Eigen::VectorXf& along, double limit,
               Eigen::VectorXf& taken) {
  const Rays rays(returns);
  taken.resize(rays.size);
  Near near;
  mark_near(rays, static_cast<Eigen::Index>(count), along.data(), limit, taken.data(), near);
  return near;
}

void sum_returns(const ReturnArrays& returns, const Eigen::Vector3d& q, const Eigen::VectorXf& along,
                 const Eigen::VectorXf& taken, std::span<const std::uint16_t> of_class,
                 CorrectionEvidence& sums) {
  for (ClassSums& one : sums.classes) one = {one.ring, one.bin};
  add_up(Rays(returns), q.z(), along.data(), taken.data(), of_class.data(), sums);
}

}  // namespace ca2
