/// @file Printed boards: what is on them, and how one is found in a picture.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/camera/camera_model.h"
#include "core/geometry/pose.h"
#include "core/types/image.h"
#include "core/types/result.h"

namespace ca2 {

/// The physical sheet or plate that carries the pattern.
struct Outline {
  double width = 0;                                  ///< m, along the board's x
  double height = 0;                                 ///< m, along the board's y
  Eigen::Vector2d center = Eigen::Vector2d::Zero();  ///< plate centre minus pattern centre, m, board frame
};

class BoardType;

/// A board as the rig file describes it. Board frame: origin at the centre of the pattern, x along the
/// columns (right), y along the rows (down), z into the board, as seen by who looks at the print.
struct Board {
  const BoardType* type = nullptr;
  int columns = 0;  ///< checkerboard: inner corners along x; charuco, aprilgrid: squares or tags along x
  int rows = 0;
  double square = 0;                        ///< m
  double marker = 0;                        ///< m, charuco only
  double spacing = 0;                       ///< aprilgrid only: gap over tag size
  std::string dictionary = "DICT_5X5_100";  ///< charuco only
  std::optional<Outline> outline;

  /// The outline, or the printed pattern where none is given: what a LiDAR sees of the board is at least
  /// this.
  Outline extent() const;
};

/// The corners' places by id, board frame, m, on a print that came out larger than stated by `stretch`:
/// printed over stated length along x and y, less 1.
std::vector<Eigen::Vector2d> printed_corners(const Board& board, const Eigen::Vector2d& stretch);

/// A corner as seen in a picture.
struct Corner {
  int id = 0;                                                ///< index into BoardType::corners
  Eigen::Vector2d pixel;                                     ///< px
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();  ///< px^2, relative between corners at least
};

/// A kind of board. Without state: one instance each, listed in boards.def.
class BoardType {
 public:
  virtual ~BoardType() = default;
  virtual std::string_view name() const = 0;
  /// What is wrong with the numbers of this board; empty when nothing.
  virtual std::vector<std::string> invalid(const Board& board) const = 0;
  /// Corner positions by id, board frame (z = 0), m.
  virtual std::vector<Eigen::Vector2d> corners(const Board& board) const = 0;
  /// Size of the printed pattern, m (all squares, without the white margin), centred on the board's origin.
  virtual Eigen::Vector2d pattern_size(const Board& board) const = 0;
  /// Is the print black at this place (board frame, m)? The sheet's margin is white.
  virtual bool black(const Board& board, const Eigen::Vector2d& p) const = 0;
  /// Does the pattern look the same after half a turn, so that corner ids are ambiguous?
  virtual bool half_turn_ambiguous(const Board& board) const = 0;
  /// Does a part of the pattern look like another part, so that only the whole of it can be placed?
  virtual bool repeats(const Board&) const { return false; }
  /// Finds the corners in an 8-bit grey picture, to about half a pixel; empty when the board is not there.
  /// Ids of an ambiguous board are one of the two choices. Deterministic.
  virtual std::vector<Corner> find(const Board& board, const Image& grey8) const = 0;
};

/// The types of boards.def, in its order.
std::span<const BoardType* const> board_types();
/// nullptr when there is none of that name.
const BoardType* find_board_type(std::string_view name);

/// The whole search: finds, refines to sub-pixel with a covariance per corner (noise of this picture, blur
/// and perspective considered). Empty when the board is not there.
std::vector<Corner> detect_board(const Board& board, const Image& image);

/// Where a camera sees the board.
struct BoardPose {
  Pose T_camera_board;
  Matrix6d covariance = Matrix6d::Identity();  ///< right perturbation (rotation, translation)
  double reprojection_rms = 0;                 ///< px
};

/// Board pose from corners (at least 4, not on a line): planar pose in both of its solutions, the better
/// one after refinement through the true camera model (Levenberg-Marquardt on pixel residuals weighted by
/// the corners' covariances). Works beyond 90 degrees off the axis too. `stretch`: of the print, see
/// printed_corners. Fails with ErrorCode::data.
Result<BoardPose> estimate_board_pose(const Board& board, const Camera& camera,
                                      std::span<const Corner> corners,
                                      const Eigen::Vector2d& stretch = Eigen::Vector2d::Zero());

}  // namespace ca2
