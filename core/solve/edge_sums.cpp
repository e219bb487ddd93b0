#include "core/solve/edge_sums.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace ca2 {
namespace {

/// Nothing is known better than to this share of the gap between two rays.
constexpr double least_blur = 0.1;
/// Of the widest beams, rad.
constexpr double half_beam = 0.003;

/// A crossing as one side of the plate sees it, in radians outwards of that side.
struct Piece {
  Eigen::Vector3d direction;  ///< unit, of the gap's middle
  double middle = 0;          ///< outwards of the predicted side
  double width = 0;           ///< of the gap
  double along = 0;           ///< place along the side, from its middle
};

/// One side of the plate, where it is predicted.
struct Side {
  Eigen::Vector3d a, b;    ///< board frame, m
  Eigen::Vector3d normal;  ///< unit, of the plane with the origin, outwards
  Eigen::Vector3d across;  ///< unit, along the side, sensor frame
  Eigen::Vector3d middle;  ///< m, sensor frame
  double half_length = 0;  ///< m
};

std::array<Side, 4> sides_of(const Outline& outline, const Pose& T_lidar_board) {
  const double w = 0.5 * outline.width, h = 0.5 * outline.height;
  // Round the plate so that a x b points outwards, seen by who looks at the print.
  const std::array<Eigen::Vector2d, 4> corners{Eigen::Vector2d(w, h), Eigen::Vector2d(w, -h),
                                               Eigen::Vector2d(-w, -h), Eigen::Vector2d(-w, h)};
  std::array<Side, 4> sides;
  for (std::size_t i = 0; i < 4; ++i) {
    Side& side = sides[i];
    side.a << outline.center + corners[i], 0;
    side.b << outline.center + corners[(i + 1) % 4], 0;
    const Eigen::Vector3d A = T_lidar_board * side.a, B = T_lidar_board * side.b;
    side.normal = A.cross(B).normalized();
    side.across = (B - A).normalized();
    side.middle = 0.5 * (A + B);
    side.half_length = 0.5 * (B - A).norm();
  }
  return sides;
}

/// The covariance of the pieces' errors, rad^2.
Eigen::MatrixXd covariance_of(const std::vector<Piece>& pieces, const EdgeNoise& noise, const Side& side) {
  const auto count = static_cast<Eigen::Index>(pieces.size());
  Eigen::MatrixXd C(count, count);
  const double range = side.middle.norm();
  const double shared = noise.shared / range;
  const double half = side.half_length / range;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Piece& p = pieces[static_cast<std::size_t>(i)];
    const double least = least_blur * p.width;
    for (Eigen::Index k = 0; k <= i; ++k) {
      const Piece& q = pieces[static_cast<std::size_t>(k)];
      const double share = std::min(1.0, std::abs(p.middle - q.middle) / (0.5 * (p.width + q.width)));
      C(i, k) = p.width * q.width / 12 * (1 - 6 * share * (1 - share)) +
                shared * shared * (1 + p.along * q.along / (half * half));
    }
    C(i, i) += noise.blur * noise.blur + least * least;
  }
  return C.selfadjointView<Eigen::Lower>();
}

/// Takes out what is not the plate's rim: crossings whose gap lies away from where most of the side's are.
void drop_strays(std::vector<Piece>& pieces) {
  if (pieces.size() < 4) return;
  std::vector<double> middles;
  for (const Piece& piece : pieces) middles.push_back(piece.middle);
  const auto half = middles.begin() + static_cast<std::ptrdiff_t>(middles.size() / 2);
  std::nth_element(middles.begin(), half, middles.end());
  std::erase_if(pieces, [&](const Piece& piece) {
    return std::abs(piece.middle - *half) > 0.9 * piece.width + half_beam;
  });
}

EdgeSums sum_up(const Side& side, const std::vector<Piece>& pieces, const EdgeNoise& noise) {
  EdgeSums sums;
  sums.a = side.a;
  sums.b = side.b;
  sums.count = static_cast<int>(pieces.size());
  const auto count = static_cast<Eigen::Index>(pieces.size());
  const Eigen::MatrixXd C = covariance_of(pieces, noise, side);
  Eigen::LLT<Eigen::MatrixXd> llt(C);
  if (llt.info() != Eigen::Success) {
    // Gaps of different width need not give a covariance: then their own variances do.
    llt.compute(Eigen::MatrixXd(C.diagonal().asDiagonal()));
  }
  Eigen::MatrixXd rows(count, 7);  // by z, and by offset and slope of the side's line; the crossings
  for (Eigen::Index i = 0; i < count; ++i) {
    const Piece& piece = pieces[static_cast<std::size_t>(i)];
    rows.row(i) << piece.direction.transpose(), -1, 1, piece.along, piece.middle;
  }
  llt.matrixL().solveInPlace(rows);
  sums.H = rows.leftCols<4>().transpose() * rows.leftCols<4>();
  if (count >= 4) {
    const Eigen::Matrix2d line = rows.middleCols<2>(4).transpose() * rows.middleCols<2>(4);
    const Eigen::Vector2d fit = rows.middleCols<2>(4).transpose() * rows.col(6);
    sums.scatter = rows.col(6).squaredNorm() - fit.dot(line.ldlt().solve(fit));
    sums.freedom = static_cast<int>(count) - 2;
  }
  return sums;
}

}  // namespace

Eigen::Vector4d EdgeSums::at(const Pose& T_lidar_board, double dilation) const {
  Eigen::Vector4d z;
  z << (T_lidar_board * a).cross(T_lidar_board * b).normalized(), dilation;
  return z;
}

std::vector<EdgeSums> edge_sums(std::span<const EdgeCrossing> crossings, const Outline& outline,
                                const Pose& T_lidar_board, double dilation, const EdgeNoise& noise,
                                double slack) {
  const std::array<Side, 4> sides = sides_of(outline, T_lidar_board);
  const Eigen::Vector3d m = T_lidar_board.R.col(2);
  const double distance = m.dot(T_lidar_board.t);
  std::array<std::vector<Piece>, 4> along_rings;
  // Between two rings the rim of a side is beyond every place that the last one saw, and before every place
  // that the next one saw past it.
  struct Strip {
    double inside = -std::numeric_limits<double>::infinity();
    double outside = std::numeric_limits<double>::infinity();
  };
  std::array<Strip, 4> strips;
  for (const EdgeCrossing& crossing : crossings) {
    if (crossing.jump < 0) continue;
    const Eigen::Vector3d inside = crossing.inside.cast<double>(), outside = crossing.outside.cast<double>();
    const Eigen::Vector3d direction = (inside + outside).normalized();
    const double reach = distance / m.dot(direction);
    if (!(reach > 0)) continue;
    for (std::size_t i = 0; i < 4; ++i) {
      const Side& side = sides[i];
      const double from = side.normal.dot(inside), to = side.normal.dot(outside);
      const double width = to - from;
      if (!(width > 0)) continue;
      const Eigen::Vector3d on_plane = reach * direction - side.middle;
      const double place = side.across.dot(on_plane);
      // Near a corner it is not known which side was crossed.
      const double gap = reach * (outside - inside).norm();
      if (std::abs(place) > side.half_length - gap - 0.01) continue;
      const double middle = 0.5 * (from + to);
      if (std::abs(middle - dilation) > 0.5 * width + slack / reach) continue;
      if (crossing.across_rings) {
        strips[i].inside = std::max(strips[i].inside, from);
        strips[i].outside = std::min(strips[i].outside, to);
      } else {
        along_rings[i].push_back({direction, middle, width, place / reach});
      }
      break;
    }
  }
  std::vector<EdgeSums> sums;
  for (std::size_t i = 0; i < 4; ++i) {
    std::vector<Piece>& pieces = along_rings[i];
    drop_strays(pieces);
    const Strip& strip = strips[i];
    // A side that rings cross is known from them; what lies between two rings says the same, less well.
    if (pieces.empty() && strip.outside > strip.inside && std::isfinite(strip.outside - strip.inside)) {
      const double middle = 0.5 * (strip.inside + strip.outside);
      const Eigen::Vector3d at_rim = sides[i].middle.normalized();
      pieces.push_back(
          {(at_rim + middle * sides[i].normal).normalized(), middle, strip.outside - strip.inside, 0});
    }
    if (!pieces.empty()) sums.push_back(sum_up(sides[i], pieces, noise));
  }
  return sums;
}

std::optional<double> center_offset(std::span<const EdgeSums> edges, const Pose& T_lidar_board,
                                    double dilation) {
  // The dilation is left free: where one side is known better than that opposite, it would be a shift.
  Eigen::Matrix3d H = 1 / (dilation_sigma * dilation_sigma) * Eigen::Vector3d::UnitZ().asDiagonal();
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
  constexpr double step = 1e-4;  // m
  for (const EdgeSums& edge : edges) {
    const Eigen::Vector4d z = edge.at(T_lidar_board, dilation);
    Eigen::Matrix<double, 4, 3> D;
    for (int k = 0; k < 2; ++k) {
      Pose moved = T_lidar_board;
      moved.t += step * T_lidar_board.R.col(k);
      D.col(k) = (edge.at(moved, dilation) - z) / step;
    }
    D.col(2) = Eigen::Vector4d::UnitW();
    H += D.transpose() * edge.H * D;
    g += D.transpose() * (edge.H * z);
  }
  const Eigen::LDLT<Eigen::Matrix3d> ldlt(H);
  if (edges.empty() || ldlt.info() != Eigen::Success || !ldlt.isPositive()) return std::nullopt;
  const Eigen::Matrix3d covariance = ldlt.solve(Eigen::Matrix3d::Identity());
  constexpr double known = 0.01;  // m
  if (!(covariance.topLeftCorner<2, 2>().trace() < 2 * known * known)) return std::nullopt;
  return (covariance * g).head<2>().norm();
}

}  // namespace ca2
