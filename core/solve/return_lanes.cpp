#include "core/solve/return_lanes.h"

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
  const float *x, *y, *z, *height;
  const double* range;
  Eigen::Index size;
};

/// What is summed: r is the residual, J its derivative by the plane's inverse and the range slope.
enum Term : std::size_t { n, r, J0, J1, J2, J3, class_terms };

CA2_HOT_LOOP void meet(const Rays& rays, const Eigen::Vector3d& q, double* along) {
  for (Eigen::Index i = 0; i < rays.size; i += ReturnArrays::lanes) {
    Four x, y, z, height;
    load(x, rays.x + i);
    load(y, rays.y + i);
    load(z, rays.z + i);
    load(height, rays.height + i);
    store(along + i, (1 - height * q[2]) / (x * q[0] + y * q[1] + z * q[2]));
  }
}

CA2_HOT_LOOP void place(const Rays& rays, const double* along, const Eigen::Vector3d& axis, double origin,
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

CA2_HOT_LOOP void add_up(const Rays& rays, double q_z, const double* along, const double* taken,
                         const std::uint16_t* of_class, CorrectionEvidence& sums) {
  Four JJ[10] = {}, rJ[4] = {}, rr = {};
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
    for (Eigen::Index k = 0; k < ReturnArrays::lanes; ++k) {
      ClassSums& its = sums.classes[of_class[i + k]];
      its.count += one[n][k];
      its.r += one[r][k];
      for (int row = 0; row < 4; ++row) its.J[row] += J[row][k];
    }
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
  rays.setZero(padded, 4);
  range.setZero(padded);
}

void ReturnArrays::set(std::size_t i, const Eigen::Vector3d& u, double height, double r) {
  const auto row = static_cast<Eigen::Index>(i);
  rays.row(row) << u.cast<float>().transpose(), static_cast<float>(height);
  range(row) = r;
}

void meet_plate(const ReturnArrays& returns, const Pose& T_lidar_board, Meetings& meetings) {
  const Rays rays(returns);
  meet_plane(returns, inverse_plane(board_plane(T_lidar_board)), meetings.along);
  meetings.x.resize(rays.size);
  meetings.y.resize(rays.size);
  const Eigen::Vector3d x = T_lidar_board.R.col(0), y = T_lidar_board.R.col(1);
  place(rays, meetings.along.data(), x, x.dot(T_lidar_board.t), meetings.x.data());
  place(rays, meetings.along.data(), y, y.dot(T_lidar_board.t), meetings.y.data());
}

void meet_plane(const ReturnArrays& returns, const Eigen::Vector3d& q, Eigen::VectorXd& along) {
  const Rays rays(returns);
  along.resize(rays.size);
  meet(rays, q, along.data());
}

void sum_returns(const ReturnArrays& returns, const Eigen::Vector3d& q, const Eigen::VectorXd& along,
                 const Eigen::VectorXd& taken, std::span<const std::uint16_t> of_class,
                 CorrectionEvidence& sums) {
  for (ClassSums& one : sums.classes) one = {one.ring, one.bin};
  add_up(Rays(returns), q.z(), along.data(), taken.data(), of_class.data(), sums);
}

}  // namespace ca2
