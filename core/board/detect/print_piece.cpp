#include "core/board/detect/print_piece.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <optional>
#include <set>

namespace ca2 {
namespace {

constexpr int reach = 2;               // squares beside one whose corners tell where it is
constexpr double corner_sigma = 0.3;   // px, of the search
constexpr double vanish_sigma = 0.08;  // per square: how fast perspective may make squares smaller
constexpr double bend_sigma = 0.02;    // of a square's side: how much a lens may bend a line per square

/// 1, u, v, and half of their squares with their product.
Eigen::Matrix<double, 6, 1> powers(double u, double v) {
  return {1.0, u, v, 0.5 * u * u, u * v, 0.5 * v * v};
}

}  // namespace

PrintPiece print_piece(const Lattice& lattice, const Lines& lines) {
  double sense = 0;
  for (const auto& [cell, node] : lattice) {
    const auto right = lattice.find(cell + Cell{1, 0});
    const auto down = lattice.find(cell + Cell{0, 1});
    if (right == lattice.end() || down == lattice.end()) continue;
    const Eigen::Vector2d x = right->second.saddle.pixel - node.saddle.pixel;
    const Eigen::Vector2d y = down->second.saddle.pixel - node.saddle.pixel;
    sense += x.x() * y.y() - x.y() * y.x() > 0 ? 1 : -1;
  }
  const bool flip = sense < 0;
  PrintPiece piece{{}, lines};
  // What lies between two lines lies between the same two from the other side.
  if (flip) piece.lines.first.second = -lines.first.second - 1;
  for (const auto& [cell, node] : lattice)
    piece.corners[{cell.first, flip ? -cell.second : cell.second}] = node.saddle.pixel;
  return piece;
}

Eigen::Vector2d PrintSquare::pixel(double x, double y) const {
  const double u = x - 0.5, v = y - 0.5;
  const Eigen::Matrix<double, 6, 1> place = powers(u, v);
  return origin_ + Eigen::Vector2d(place.dot(fit_.head<6>()), place.dot(fit_.segment<6>(6))) /
                       (1 + u * fit_[12] + v * fit_[13]);
}

/// By the homography, bent by a lens, that fits the corners best, nearer ones with more weight. Few or small
/// squares do not tell all of that: as much as is usual is believed.
std::optional<PrintSquare> print_square(const PrintPiece& piece, const Cell& cell) {
  Eigen::Matrix<double, 14, 14> information = Eigen::Matrix<double, 14, 14>::Zero();
  PrintSquare::Fit right = PrintSquare::Fit::Zero();
  Eigen::Matrix3d plane = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, 2> moved = Eigen::Matrix<double, 3, 2>::Zero();
  const Eigen::Vector2d* origin = nullptr;
  for (int j = -reach; j <= reach + 1; ++j) {
    for (int i = -reach; i <= reach + 1; ++i) {
      const auto corner = piece.corners.find(cell + Cell{i, j});
      if (corner == piece.corners.end()) continue;
      if (origin == nullptr) origin = &corner->second;
      const Eigen::Vector2d p = corner->second - *origin;
      const Eigen::Vector2d middle = piece.lines.place(cell + Cell{i, j}) - piece.lines.place(cell);
      const double u = middle.x() - 0.5, v = middle.y() - 0.5;
      const double weight = 1 / ((u * u + v * v) * (u * u + v * v));
      const Eigen::Matrix<double, 6, 1> place = powers(u, v);
      plane += weight * place.head<3>() * place.head<3>().transpose();
      moved += weight * place.head<3>() * p.transpose();
      for (int axis = 0; axis < 2; ++axis) {
        PrintSquare::Fit row = PrintSquare::Fit::Zero();
        row.segment<6>(6 * axis) = place;
        row.tail<2>() << -u * p[axis], -v * p[axis];
        information += weight * row * row.transpose();
        right += weight * row * p[axis];
      }
    }
  }
  if (!(plane.determinant() > 1e-6)) return std::nullopt;
  const double side = plane.ldlt().solve(moved).bottomRows<2>().norm() / std::sqrt(2.0);
  const double bend = corner_sigma / (bend_sigma * side), vanish = corner_sigma / vanish_sigma;
  information.diagonal().segment<3>(3).array() += bend * bend;
  information.diagonal().segment<3>(9).array() += bend * bend;
  information.diagonal().tail<2>().array() += vanish * vanish;
  return PrintSquare(*origin, information.ldlt().solve(right));
}

std::vector<Cell> printed_squares(const PrintPiece& piece) {
  std::set<Cell> squares;
  for (const auto& [cell, pixel] : piece.corners) {
    for (const Cell& beside : {Cell{0, 0}, Cell{-1, 0}, Cell{0, -1}, Cell{-1, -1}}) {
      if (piece.lines.printed(cell + beside)) squares.insert(cell + beside);
    }
  }
  return {squares.begin(), squares.end()};
}

}  // namespace ca2
