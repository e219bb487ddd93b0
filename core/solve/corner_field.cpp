#include "core/solve/corner_field.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/types/four.h"
#include "core/types/hot_loop.h"

namespace ca2 {
namespace {

/// Of the error from which the cost is linear: up to here a corner's cost is held for quadratic while the
/// board moves within reach and the noise is estimated anew.
constexpr double certain = 0.75;

double huber_cost(double norm, double k) {
  return norm <= k ? 0.5 * norm * norm : k * (norm - 0.5 * k);
}

/// W with W'W = covariance^-1, lower triangular.
Eigen::Matrix2d whitening(const Eigen::Matrix2d& covariance) {
  const double a = 1 / std::sqrt(covariance(0, 0)), b = covariance(1, 0) * a;
  const double c = 1 / std::sqrt(covariance(1, 1) - b * b);
  Eigen::Matrix2d W;
  W << a, 0, -a * b * c, c;
  return W;
}

/// H = J J' (lower triangle) of `size` rows of `length` numbers, a multiple of four.
CA2_HOT_LOOP void square(const double* J, Eigen::Index size, Eigen::Index length,
                         CameraEquations::Matrix& H) {
  for (Eigen::Index row = 0; row < size; ++row) {
    for (Eigen::Index column = 0; column <= row; ++column) {
      Four products = {};
      for (Eigen::Index i = 0; i < length; i += 4) {
        Four a, b;
        load(a, J + row * length + i);
        load(b, J + column * length + i);
        products += a * b;
      }
      H(row, column) = sum(products);
    }
  }
}

/// errors += J' way, row by row of J.
CA2_HOT_LOOP void move_along(const double* J, Eigen::Index stride, Eigen::Index size, const double* way,
                             Eigen::Index count, double* errors) {
  for (Eigen::Index k = 0; k < size; ++k) {
    const double* row = J + k * stride;
    for (Eigen::Index i = 0; i < count; ++i) errors[i] += way[k] * row[i];
  }
}

/// g += J (off e), H += off J J' with the `size` rows of one corner's J, `stride` numbers apart.
CA2_HOT_LOOP void add_corner(const double* J, Eigen::Index stride, Eigen::Index size, double off,
                             const double* e, double* g, double* H) {
  double x[CameraEquations::most], y[CameraEquations::most];
  const double e_x = off * e[0], e_y = off * e[1];
  for (Eigen::Index k = 0; k < size; ++k) {
    x[k] = J[k * stride];
    y[k] = J[k * stride + 1];
    g[k] += x[k] * e_x + y[k] * e_y;
  }
  for (Eigen::Index column = 0; column < size; ++column, H += size) {
    for (Eigen::Index row = 0; row < size; ++row) H[row] += off * (x[column] * x[row] + y[column] * y[row]);
  }
}

Eigen::Vector3d as_printed(const Eigen::Vector3d& stated, const Eigen::Vector2d& stretch) {
  return {stated.x() * (1 + stretch.x()), stated.y() * (1 + stretch.y()), 0};
}

}  // namespace

CornerField::CornerField(std::span<const Corner> corners, std::span<const Eigen::Vector2d> positions,
                         const CornerUnknowns& unknowns)
    : unknowns_(unknowns),
      size_(6 + unknowns.parameters + (unknowns.stretch ? 2 : 0)),
      parameters_(CameraParameters::Zero(unknowns.parameters)),
      moves_(CameraParameters::Zero(unknowns.parameters)),
      e_(Eigen::Matrix2Xd::Zero(2, static_cast<Eigen::Index>(corners.size()))),
      J_(size_, 4 * ((static_cast<Eigen::Index>(corners.size()) + 1) / 2)) {
  J_.rightCols(J_.cols() - e_.size()).setZero();
  corners_.reserve(corners.size());
  for (const Corner& corner : corners) {
    const Eigen::Vector2d& xy = positions[static_cast<std::size_t>(corner.id)];
    corners_.push_back({corner.id, {xy.x(), xy.y(), 0}, corner.pixel, whitening(corner.covariance)});
  }
}

CornerField::Vector CornerField::way_to(const CornerModel& model) const {
  Vector way(size_);
  way.head<6>() = T_camera_board_.difference(model.T_camera_board);
  way.segment(6, parameters_.size()) = model.camera.parameters.head(parameters_.size()) - parameters_;
  if (unknowns_.stretch) way.tail<2>() = model.stretch - stretch_;
  return way;
}

bool CornerField::close(const Vector& way, const CornerModel& model) const {
  return way.head<3>().norm() <= reach_ &&
         way.segment<3>(3).norm() <= reach_ * model.T_camera_board.t.norm() &&
         way.segment(6, moves_.size()).cwiseProduct(moves_).lpNorm<Eigen::Infinity>() <= intrinsics_reach &&
         (model.stretch - stretch_).lpNorm<Eigen::Infinity>() <= reach_;
}

bool CornerField::project(const CornerModel& model) {
  approached_ = false;
  const Pose& T_camera_board = model.T_camera_board;
  moves_.setZero();
  ProjectionJacobian jacobian;
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    const Seen& corner = corners_[i];
    const Eigen::Vector3d printed = as_printed(corner.p_board, model.stretch);
    const auto pixel = model.camera.project(T_camera_board * printed, &jacobian);
    if (!pixel) return false;
    const Eigen::Matrix2d& W = corner.whitening;
    e_.col(static_cast<Eigen::Index>(i)) = W * (*pixel - corner.pixel);
    Eigen::Matrix<double, 2, 3> whitened;
    whitened.row(0) = W(0, 0) * jacobian.point.row(0);
    whitened.row(1) = W(1, 0) * jacobian.point.row(0) + W(1, 1) * jacobian.point.row(1);
    const Eigen::Matrix<double, 2, 3> by_translation = whitened.lazyProduct(T_camera_board.R);
    const Eigen::Vector2d by_x = by_translation.col(0), by_y = by_translation.col(1),
                          by_z = by_translation.col(2);
    // Number by number: blocks of a size that is not known when this is compiled cost more than what is in
    // them.
    double* J = J_.data() + 2 * i;
    const auto put = [&](double x, double y) {
      J[0] = x;
      J[1] = y;
      J += J_.cols();
    };
    // By a turn: what is printed lies in the plane z = 0.
    put(printed.y() * by_z.x(), printed.y() * by_z.y());
    put(-printed.x() * by_z.x(), -printed.x() * by_z.y());
    put(printed.x() * by_y.x() - printed.y() * by_x.x(), printed.x() * by_y.y() - printed.y() * by_x.y());
    for (Eigen::Index k = 0; k < 3; ++k) put(by_translation(0, k), by_translation(1, k));
    for (Eigen::Index k = 0; k < moves_.size(); ++k) {
      const double x = jacobian.parameters(0, k), y = jacobian.parameters(1, k);
      put(W(0, 0) * x, W(1, 0) * x + W(1, 1) * y);
      moves_(k) = std::max(moves_(k), std::max(std::abs(x), std::abs(y)));
    }
    for (Eigen::Index k = 0; unknowns_.stretch && k < 2; ++k)
      put(corner.p_board(k) * by_translation(0, k), corner.p_board(k) * by_translation(1, k));
  }
  T_camera_board_ = T_camera_board;
  parameters_ = model.camera.parameters.head(parameters_.size());
  stretch_ = model.stretch;
  approached_ = true;
  limit_ = 0;
  return true;
}

void CornerField::settle(double limit) {
  settled_ = CameraEquations(size_);
  settled_up_to_ = 0;
  limit_ = limit;
  single_.clear();
  for (std::size_t i = 0; i < size(); ++i) {
    const double squared = e(i).squaredNorm();
    if (squared > limit * limit) {
      single_.push_back(i);
    } else {
      settled_up_to_ = std::max(settled_up_to_, squared);
    }
  }
  settled_up_to_ = std::sqrt(settled_up_to_);
  // All as if their cost were quadratic; the single ones are put right wherever they are asked for.
  settled_.cost = 0.5 * e_.squaredNorm();
  settled_.g.noalias() = J_.leftCols(e_.size()) * e_.reshaped();
  square(J_.data(), size_, J_.cols(), settled_.H);
  settled_.H.triangularView<Eigen::StrictlyUpper>() = settled_.H.transpose();
}

bool CornerField::approach(const CornerModel& model, double scale, double huber, double reach) {
  reach_ = reach;
  if (!approached_ || !close(way_to(model), model)) {
    if (!project(model)) return false;
  }
  const double limit = certain * huber * scale;
  if (limit_ == 0 || settled_up_to_ > 1.1 * limit || limit_ < 0.8 * limit) settle(limit);
  return true;
}

CameraEquations CornerField::equations(const CornerModel& model, double scale, double huber) const {
  const Vector way = way_to(model);
  CameraEquations sum = settled_;
  const Vector H_way = settled_.H.lazyProduct(way);
  sum.cost += settled_.g.dot(way) + 0.5 * way.dot(H_way);
  sum.g += H_way;
  for (const std::size_t i : single_) {
    const Eigen::Vector2d there = e(i) + J(i).transpose().lazyProduct(way);
    const double norm = there.norm();
    if (norm <= huber * scale) continue;
    const double off = huber * scale / norm - 1;  // of its weight
    sum.cost += huber_cost(norm, huber * scale) - 0.5 * norm * norm;
    add_corner(J_.data() + 2 * i, J_.cols(), size_, off, there.data(), sum.g.data(), sum.H.data());
  }
  const double information = 1 / (scale * scale);
  sum.cost *= information;
  sum.g *= information;
  sum.H *= information;
  return sum;
}

double CornerField::cost(const CornerModel& model, double scale, double huber) const {
  double sum = 0;
  const Vector way = approached_ ? way_to(model) : Vector();
  if (approached_ && close(way, model)) {
    const Vector H_way = settled_.H.lazyProduct(way);
    sum = settled_.cost + settled_.g.dot(way) + 0.5 * way.dot(H_way);
    for (const std::size_t i : single_) {
      const double norm = (e(i) + J(i).transpose().lazyProduct(way)).norm();
      sum += huber_cost(norm, huber * scale) - 0.5 * norm * norm;
    }
  } else {
    for (const Seen& corner : corners_) {
      const auto pixel =
          model.camera.project(model.T_camera_board * as_printed(corner.p_board, model.stretch));
      if (!pixel) return std::numeric_limits<double>::infinity();
      sum += huber_cost((corner.whitening * (*pixel - corner.pixel)).norm(), huber * scale);
    }
  }
  return sum / (scale * scale);
}

Eigen::Matrix2Xd CornerField::errors_after(const Vector& way) const {
  Eigen::Matrix2Xd errors = e_;
  move_along(J_.data(), J_.cols(), size_, way.data(), errors.size(), errors.data());
  return errors;
}

Eigen::Matrix2Xd CornerField::errors(const CornerModel& model) const {
  return approached_ ? errors_after(way_to(model)) : e_;
}

Eigen::Matrix2Xd CornerField::errors_about_own_pose(const CornerModel& model) const {
  if (!approached_) return e_;
  Vector way = way_to(model);
  const Vector g = settled_.g + settled_.H * way;
  way.head<6>() -= settled_.H.topLeftCorner<6, 6>().ldlt().solve(g.head<6>());
  return errors_after(way);
}

double CornerField::rms(const CornerModel& model) const {
  const Eigen::Matrix2Xd errors = this->errors(model);
  double squares = 0;
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    squares += corners_[i]
                   .whitening.triangularView<Eigen::Lower>()
                   .solve(Eigen::Vector2d(errors.col(static_cast<Eigen::Index>(i))))
                   .squaredNorm();
  }
  return std::sqrt(squares / std::max<double>(1, static_cast<double>(corners_.size())));
}

}  // namespace ca2
