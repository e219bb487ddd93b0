#include "core/solve/edge_sums.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/solve/rim_ends.h"

namespace ca2 {
namespace {

/// Of the widest beams, rad.
constexpr double half_beam = 0.003;
/// The chance of what seems to have missed the plate not to have done so, after one ray or several next to it
/// were lost. Between rings a whole ring would have to be. A ray that ended on the plate did so.
constexpr double stray_share = 0.002;
/// How well a ray's direction is known, rad..
constexpr double least_sigma = 1e-5;
/// ..and m^2: points tell to 2 mm where it begins, and their ranges may be 12 mm off.
constexpr double origin_doubt = 4e-5;

/// The rays of a crossing as one side of the plate sees them: angles outwards of that side, rad.
struct Piece {
  double inside = 0, outside = 0;
  /// How the rim's angles at the ends of the side make up that where a ray passes it.
  Eigen::Vector2d inside_weights, outside_weights;

  double width() const { return outside - inside; }
  double middle() const { return 0.5 * (inside + outside); }
};

/// One side of the plate, where it is predicted.
struct Side {
  Eigen::Vector3d a, b;             ///< board frame, m
  Eigen::Vector3d A, B;             ///< the same, sensor frame, m
  Eigen::Vector3d normal;           ///< unit, of the plane with the origin, outwards
  Eigen::Vector3d across;           ///< unit, along the side, sensor frame
  Eigen::Vector3d middle;           ///< m, sensor frame
  double half_length = 0;           ///< m
  double reach_A = 0, reach_B = 0;  ///< of the ends from the sensor, m
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
    side.A = T_lidar_board * side.a;
    side.B = T_lidar_board * side.b;
    side.normal = side.A.cross(side.B).normalized();
    side.across = (side.B - side.A).normalized();
    side.middle = 0.5 * (side.A + side.B);
    side.half_length = 0.5 * (side.B - side.A).norm();
    side.reach_A = side.A.norm();
    side.reach_B = side.B.norm();
  }
  return sides;
}

/// The rim's plane turns by a small vector t from the predicted one: at the point P of the side it then lies
/// t.P / |P| outwards, and P is a mean of the ends.
Eigen::Vector2d weights_at(const Side& side, double place) {
  const double share = 0.5 * (1 + place / side.half_length);
  const double distance = (side.middle + place * side.across).norm();
  return {(1 - share) * side.reach_A / distance, share * side.reach_B / distance};
}

/// Where a ray that begins `height` up the z axis meets the plane of a board at T, sensor frame, m.
std::optional<Eigen::Vector3d> meet(const Pose& T_lidar_board, const Eigen::Vector3f& ray, float height) {
  const Eigen::Vector3d m = T_lidar_board.R.col(2), origin(0, 0, height), along = ray.cast<double>();
  const double reach = m.dot(T_lidar_board.t - origin) / m.dot(along);
  if (!(reach > 0)) return std::nullopt;
  return origin + reach * along;
}

/// Takes out what is not the plate's rim: crossings whose gap lies away from where most of the side's are.
void drop_strays(std::vector<Piece>& pieces) {
  if (pieces.size() < 4) return;
  std::vector<double> middles;
  for (const Piece& piece : pieces) middles.push_back(piece.middle());
  const auto half = middles.begin() + static_cast<std::ptrdiff_t>(middles.size() / 2);
  std::nth_element(middles.begin(), half, middles.end());
  std::erase_if(pieces, [&](const Piece& piece) {
    return std::abs(piece.middle() - *half) > 0.9 * piece.width() + half_beam;
  });
}

std::vector<RimRay> rays_of(const std::vector<Piece>& pieces, double dilation) {
  std::vector<RimRay> rays;
  rays.reserve(2 * pieces.size());
  for (const Piece& piece : pieces) {
    // The dilation is the same all along the side, whatever the weights' sum.
    const double inside = piece.inside - dilation * (1 - piece.inside_weights.sum());
    const double outside = piece.outside - dilation * (1 - piece.outside_weights.sum());
    rays.push_back({-piece.inside_weights, -inside, 0});
    rays.push_back({piece.outside_weights, outside, piece.width()});
  }
  return rays;
}

std::optional<EdgeSums> sum_up(const Side& side, const std::vector<Piece>& pieces, const Dilation& seen,
                               double slack, const EdgeNoise& noise, double strays) {
  EdgeSums sums;
  sums.a = side.a;
  sums.b = side.b;
  sums.count = static_cast<int>(pieces.size());
  const double range = side.middle.norm();
  const double dilation = seen.at(range);
  // So wide that it tells nothing.
  const double reach = 4 * slack / range;
  const auto ends = find_rim_ends(rays_of(pieces, dilation), {dilation, reach, noise.blur, strays});
  if (!ends) return std::nullopt;
  sums.blur = ends->blur;
  sums.range = range;
  const double direction = std::hypot(least_sigma, origin_doubt / (range * range));
  sums.covariance = ends->covariance + (direction * direction + noise.blur * noise.blur / sums.count) *
                                           Eigen::Matrix2d::Identity();
  // Angles that the rays leave as open as they were are not known.
  const double trace = ends->covariance.trace(), determinant = ends->covariance.determinant();
  const double open = 0.25 * reach * reach / 3;
  const double larger = 0.5 * trace + std::sqrt(std::max(0.0, 0.25 * trace * trace - determinant));
  sums.freedom = (larger < open ? 1 : 0) + (trace - larger < open ? 1 : 0);
  sums.rows << (side.A.normalized() + ends->mean(0) * side.normal).normalized().transpose(), -1,
      (side.B.normalized() + ends->mean(1) * side.normal).normalized().transpose(), -1;
  sums.share(noise);
  return sums;
}

}  // namespace

Eigen::Matrix2d shared_covariance(const EdgeNoise& noise, double range) {
  const double angle = noise.shared / range;
  return angle * angle * Eigen::Matrix2d::Identity() +
         noise.backdrop * noise.backdrop * Eigen::Matrix2d::Ones();
}

void EdgeSums::share(const EdgeNoise& noise) {
  H = rows.transpose() * (covariance + shared_covariance(noise, range)).inverse() * rows;
}

Eigen::Vector4d EdgeSums::at(const Pose& T_lidar_board, const Dilation& dilation) const {
  Eigen::Vector4d z;
  z << (T_lidar_board * a).cross(T_lidar_board * b).normalized(), dilation.at(range);
  return z;
}

std::vector<EdgeSums> edge_sums(std::span<const EdgeCrossing> crossings, const Outline& outline,
                                const Pose& T_lidar_board, const Dilation& dilation, const EdgeNoise& noise,
                                double slack) {
  const std::array<Side, 4> sides = sides_of(outline, T_lidar_board);
  std::array<std::vector<Piece>, 4> by_side, between_rings;
  for (std::vector<Piece>& pieces : by_side) pieces.reserve(crossings.size() / 2);
  for (const EdgeCrossing& crossing : crossings) {
    if (crossing.jump < least_jump) continue;
    const auto p_inside = meet(T_lidar_board, crossing.inside, crossing.inside_height);
    const auto p_outside = meet(T_lidar_board, crossing.outside, crossing.outside_height);
    if (!p_inside || !p_outside) continue;
    // As they are seen from the origin, wherever they begin.
    const double range = p_inside->norm(), angle = dilation.at(range);
    const Eigen::Vector3d inside = *p_inside / range, outside = p_outside->normalized();
    const double gap = range * (outside - inside).norm();
    for (std::size_t i = 0; i < 4; ++i) {
      const Side& side = sides[i];
      Piece piece{side.normal.dot(inside), side.normal.dot(outside), {}, {}};
      if (!(piece.width() > 0)) continue;
      const double from = side.across.dot(*p_inside - side.middle);
      const double to = side.across.dot(*p_outside - side.middle);
      // Near a corner it is not known which side was crossed.
      if (0.5 * std::abs(from + to) > side.half_length - gap - 0.01) continue;
      if (std::abs(piece.middle() - angle) > 0.5 * piece.width() + slack / range) continue;
      piece.inside_weights = weights_at(side, from);
      piece.outside_weights = weights_at(side, to);
      (crossing.across_rings ? between_rings : by_side)[i].push_back(piece);
      break;
    }
  }
  std::vector<EdgeSums> sums;
  sums.reserve(4);
  for (std::size_t i = 0; i < 4; ++i) {
    // A side that rings cross is known from them; what lies between two rings says the same, less well.
    const bool crossed = !by_side[i].empty();
    std::vector<Piece>& pieces = crossed ? by_side[i] : between_rings[i];
    drop_strays(pieces);
    if (pieces.empty()) continue;
    if (const auto side = sum_up(sides[i], pieces, dilation, slack, noise, crossed ? stray_share : 0)) {
      sums.push_back(*side);
    }
  }
  return sums;
}

std::optional<double> center_offset(std::span<const EdgeSums> edges, const Pose& T_lidar_board,
                                    const Dilation& dilation) {
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
