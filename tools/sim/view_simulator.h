/// @file One hold of the board as every sensor of a rig records it.
#pragma once

#include <map>
#include <string>

#include "core/types/image.h"
#include "core/types/result.h"
#include "core/types/scan.h"
#include "tools/sim/ray_grid.h"
#include "tools/sim/scenario.h"
#include "tools/sim/scene.h"

namespace ca2 {

struct RenderedView {
  std::map<std::string, Image> images;  ///< by camera of the view's group
  std::map<std::string, Scan> scans;    ///< by LiDAR of the view's group
  /// By sensor: where the board was; for LiDARs of a `moved` view, where it was when the picture was taken.
  std::map<std::string, Pose> T_sensor_board;
  WrongObject wrong_object = WrongObject::none;
};

/// Holds what all views share: the furnished room, and the cameras' rays.
class ViewSimulator {
 public:
  /// The scenario must outlive the simulator and have a room.
  explicit ViewSimulator(const Scenario& scenario);

  /// View `id`, numbered from 1, from its own generator: in any order, from several threads.
  /// ErrorCode::config when the scenario has no place for the board.
  Result<RenderedView> render(int id) const;

 private:
  const Scenario& scenario_;
  Scene room_;
  std::map<std::string, RayGrid> rays_;
};

}  // namespace ca2
