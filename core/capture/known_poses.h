/// @file Poses of the board that the session has already: a view must teach.
#pragma once

#include <optional>
#include <set>
#include <vector>

#include "core/board/board.h"
#include "core/features/sights.h"

namespace ca2 {

/// Where one view has the board, by camera; for one without intrinsics, its corners.
struct ViewPose {
  int id = 0;
  std::vector<std::optional<Pose>> T_camera_board;
  std::vector<std::vector<Corner>> corners;
  std::set<int> lidars;  ///< that saw it
};

class KnownPoses {
 public:
  void add(ViewPose pose) { views_.push_back(std::move(pose)); }
  void remove(int id);

  /// The view that shows the board at this place already, to at least the same LiDARs; nothing for a new one.
  std::optional<int> find_same(const ViewPose& pose) const;

 private:
  std::vector<ViewPose> views_;
};

/// `intrinsics`: by camera, are they known?
ViewPose pose_of_view(const ViewSights& sights, const std::vector<bool>& intrinsics);

}  // namespace ca2
