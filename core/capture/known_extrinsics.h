/// @file What is known about where the LiDARs are: tells the board from other things of its size.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/features/sights.h"
#include "core/session/calibration.h"
#include "core/session/rig.h"

namespace ca2 {

/// T_camera_lidar, and how far a sight may be from where the camera sees the board.
struct ExtrinsicGuess {
  Pose T_camera_lidar;
  double distance = 0;  ///< m
  double angle = 0;     ///< rad
};

class KnownExtrinsics {
 public:
  /// The rig's: a person's first guesses are loose, fixed ones are not.
  explicit KnownExtrinsics(const Rig& rig);

  /// A calibration that the views determine well enough takes the place of guesses.
  void update(const Calibration& calibration);

  std::optional<ExtrinsicGuess> between(const std::string& camera, const std::string& lidar) const;

 private:
  struct Entry {
    std::string camera, lidar;
    ExtrinsicGuess guess;
  };
  std::vector<Entry> rig_, solved_;
};

/// How far the sight is from where the camera sees the plate, in units of what the guess allows: agrees up to
/// 1.
double disagreement(const ExtrinsicGuess& guess, const Pose& T_camera_board, const Board& board,
                    const LidarSight& sight);

}  // namespace ca2
