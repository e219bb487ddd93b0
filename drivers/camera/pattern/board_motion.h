/// @file Where the virtual camera's board is: held still, carried to the next pose, held still again.
#pragma once

#include <cstdint>

#include "core/board/board.h"
#include "core/camera/camera_model.h"
#include "core/geometry/pose.h"

namespace ca2 {

struct BoardMotionOptions {
  double hold = 2;         ///< s at every pose
  double move = 1;         ///< s from pose to pose
  std::uint64_t seed = 1;  ///< of the poses
};

/// An endless sequence of tilted poses in which the camera sees all of the board. A pure function of time.
class BoardMotion {
 public:
  BoardMotion(const Board& board, const Camera& camera, BoardMotionOptions options)
      : board_(board), camera_(camera), options_(options) {}

  struct Place {
    Pose T_camera_board;
    bool moving = false;
    std::int64_t pose = 0;  ///< number of the pose held, or of the one last held
  };
  /// `time`: s since the start.
  Place at(double time) const;

 private:
  Pose pose(std::int64_t number) const;

  Board board_;
  Camera camera_;
  BoardMotionOptions options_;
};

}  // namespace ca2
