/// @file A camera's pictures of a room in which people move: what does not move is rendered once.
#pragma once

#include <cstdint>
#include <vector>

#include "tools/sim/camera_simulator.h"
#include "tools/sim/ray_grid.h"
#include "tools/sim/scenario.h"
#include "tools/sim/scene.h"

namespace ca2 {

/// One per camera and thread: pictures are as those of render_picture but for the draws of their noise.
class PictureSequence {
 public:
  /// `room`: the solids that never move. The camera must outlive the sequence.
  PictureSequence(const SimulatedCamera& camera, const Scene& room);

  /// `scene`: the room's solids followed by those that move. The picture is a moment's: nothing is smeared by
  /// motion. `seed` makes its noise.
  Image render(const Scene& scene, std::uint64_t seed);

 private:
  PixelRegion region_of(const Scene& scene) const;

  const SimulatedCamera& camera_;
  RayGrid rays_;
  std::size_t room_solids_;
  UnprintedPicture room_;                    ///< before the lens
  std::vector<float> blurred_room_;          ///< behind it
  std::vector<Eigen::Vector3f> directions_;  ///< rig frame, of every 8th pixel
  int columns_ = 0, rows_ = 0;
  std::vector<float> noise_;  ///< draws, taken from anywhere: a generator per pixel would cost most of it all
};

}  // namespace ca2
