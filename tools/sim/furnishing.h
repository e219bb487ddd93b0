/// @file Fills a scene: the room, its furniture, the board and the people who hold it.
#pragma once

#include <optional>
#include <random>

#include "tools/sim/scenario.h"
#include "tools/sim/scene.h"

namespace ca2 {

/// The empty room with furniture and posters along its walls: the same in every view of a scenario.
Scene furnish_room(const Room& room, std::uint64_t seed);

/// A plate with the board's print at its place; returns the solid's index. The scene keeps a pointer to
/// `board`.
int add_board(Scene& scene, const Board& board, double bend, const Pose& T_rig_board);

/// A plain plate of nearly the board's size.
int add_panel(Scene& scene, const Board& board, const Pose& T_rig_panel, std::mt19937_64& rng);

/// A person who stands, or kneels, behind a plate as seen from the rig and holds it at its left and right
/// edges, the hands reaching `hand_cover` m over them.
void add_holder(Scene& scene, const Room& room, const Plate& plate, const Pose& T_rig_plate,
                std::mt19937_64& rng);

/// A person with empty hands at a place on the floor (rig frame), turned to the rig.
void add_walker(Scene& scene, const Room& room, const Eigen::Vector2d& place, std::mt19937_64& rng);

/// A person who only stands there, out of the line of sight to `p_kept_clear` (rig frame).
void add_bystander(Scene& scene, const Room& room, const Eigen::Vector3d& p_kept_clear, std::mt19937_64& rng);

}  // namespace ca2
