/// @file The crossings of a plate's rim reduced to a few sums per side.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/board/board.h"
#include "core/features/sights.h"
#include "core/geometry/pose.h"

namespace ca2 {

/// What is known of the angle by which a LiDAR sees a plate too large before anything was measured: beams are
/// 2 to 6 mrad wide, and a plate answers from any part of one. Standard deviation, rad.
inline constexpr double dilation_sigma = 0.004;

/// By how much a LiDAR sees plates too large: their rims lie outside of the plates' sides.
struct Dilation {
  double angle = 0;   ///< rad
  double margin = 0;  ///< m

  /// As an angle, of a side `range` metres away.
  double at(double range) const { return angle + margin / range; }
};

/// What rims may be off by beside an angle. Standard deviation of each before anything was measured, 0: it is
/// held at 0.
struct RimFreedom {
  double margin = 0;  ///< of Dilation::margin, m
  double depth = 0;   ///< m: of how far along the boards' z axes the rims lie, behind the print
};

/// What is known of rims: real plates are some 20 mm thick, so that their rims lie behind the print by half
/// of that, and are seen too large by half the width that beams have where they leave the LiDAR. Thin ones
/// and beams that begin as points are believed as far as the views do, see NuisanceEvidence.
inline constexpr RimFreedom rim_freedom{0.005, 0.01};

/// How well a LiDAR tells where a rim is, beside the gap between its rays.
struct EdgeNoise {
  double blur = 0;    ///< rad: a ray is trusted to within this (the beam's width, its encoder)
  double shared = 0;  ///< m: of either end of a side, all its crossings together (cut, tape, bent rim)
  /// rad: of both ends of a side together. A beam across a rim returns the stronger echo: the weaker what
  /// stands behind a side (dark, far, aslant), the further out it seems to lie.
  double backdrop = 0;
  double sway = 0;  ///< m: of all sides of a plate together, along either of its axes (a hand that holds it)
};

/// Of the angles at both ends of a side `range` metres away, by what its crossings share, rad^2.
Eigen::Matrix2d shared_covariance(const EdgeNoise& noise, double range);

/// The crossings of one side of the plate. The side and the LiDAR's origin span a plane; with its unit normal
/// n (outwards) and the dilation d at its range the cost is 1/2 z'Hz with z = (n, d): the rim lies at the
/// angle d outside of the side.
struct EdgeSums {
  Eigen::Vector3d a, b;  ///< ends of the side, board frame, m; n is along (T a) x (T b)
  Eigen::Matrix4d H = Eigen::Matrix4d::Zero();
  Eigen::Matrix<double, 2, 4> rows;  ///< what is measured of z, once at each end, rad..
  Eigen::Matrix2d covariance;        ///< ..and how well, but for what its crossings share, rad^2
  double range = 0;                  ///< m, of the side's middle
  int count = 0;                     ///< crossings
  int freedom = 0;                   ///< what they fix: 2, offset and direction of the rim; 1; 0
  double blur = 0;  ///< rad: by how much rays of this side contradict each other beyond the stated blur

  /// Makes H what it is with this noise's errors that crossings share, shared and backdrop.
  void share(const EdgeNoise& noise);
  /// z of this side for a board at T_lidar_board.
  Eigen::Vector4d at(const Pose& T_lidar_board, const Dilation& dilation) const;
};

/// A beam that lies half on the plate and half on what stands less than its pulse's length behind it (the
/// person who holds it) returns a range between both, and whether that counts as the plate is a matter of the
/// gap: such a rim seems to be up to half a beam's width off, either way. m.
inline constexpr double least_jump = 0.5;

/// The sums of all sides that crossings were seen of, the plate being at about T_lidar_board. Covered
/// crossings, those with something close behind and those near the plate's corners tell nothing; those
/// further than `slack` [m] from where the plate should end are of something else.
///
/// A ray that ended on the plate says that the rim is beyond it, its neighbour that it is before that one. A
/// straight rim has two unknowns, its angles at its ends, and what all rays of a side leave for them is a
/// convex polygon; anywhere in it is as likely. Its mean and covariance are the side's measurement (see
/// `find_rim_ends`): rings that cut their gaps at the same place count once by themselves, rings that cut
/// them at all places leave little.
std::vector<EdgeSums> edge_sums(std::span<const EdgeCrossing> crossings, const Outline& outline,
                                const Pose& T_lidar_board, const Dilation& dilation, const EdgeNoise& noise,
                                double slack);

/// Where the sides see the plate's centre: in-plane distance [m] of the centre that fits the sums best from
/// the one at T_lidar_board, everything else held. Nothing where they do not fix it to 10 mm.
std::optional<double> center_offset(std::span<const EdgeSums> edges, const Pose& T_lidar_board,
                                    const Dilation& dilation);

}  // namespace ca2
