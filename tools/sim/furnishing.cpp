#include "tools/sim/furnishing.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ca2 {
namespace {

double uniform(std::mt19937_64& rng, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(rng);
}

Material draw_material(std::mt19937_64& rng, double dark, double bright, Texture texture) {
  Material material;
  material.albedo = uniform(rng, dark, bright);
  // Near infrared looks past many dyes: the two brightnesses are related, not equal.
  material.reflectivity = std::clamp(material.albedo + uniform(rng, -0.1, 0.3), 0.05, 0.9);
  material.texture = texture;
  material.scale = uniform(rng, 0.15, 0.5);
  material.contrast = uniform(rng, 0.1, 0.35);
  return material;
}

void add_box(Scene& scene, const Pose& T_rig_item, const Eigen::Vector3d& center,
             const Eigen::Vector3d& edges, const Material& material) {
  Solid solid;
  solid.shape = Shape::box;
  solid.T_rig_solid = {T_rig_item.R, T_rig_item * center};
  solid.size = edges / 2;
  solid.material = material;
  scene.add(solid);
}

/// A place on the floor along a wall: x points into the room, y along the wall, the origin at the wall.
Pose draw_wall_place(const Room& room, std::mt19937_64& rng) {
  const int wall = std::uniform_int_distribution<int>(0, 3)(rng);
  const double angle = wall * std::numbers::pi / 2;
  const bool short_wall = wall % 2 == 0;
  const double to_wall = (short_wall ? room.length : room.width) / 2;
  const double along = uniform(rng, -0.42, 0.42) * (short_wall ? room.width : room.length);
  Pose T_rig_wall;
  T_rig_wall.R = so3_exp({0, 0, angle});
  T_rig_wall.t = T_rig_wall.R * Eigen::Vector3d(-to_wall, along, 0) - Eigen::Vector3d(0, 0, room.rig_height);
  return T_rig_wall;
}

void add_table(Scene& scene, const Pose& place, std::mt19937_64& rng) {
  const double width = uniform(rng, 1.0, 1.6), depth = 0.65, height = uniform(rng, 0.68, 0.78);
  const Material wood = draw_material(rng, 0.3, 0.6, Texture::blotches);
  add_box(scene, place, {depth / 2 + 0.03, 0, height}, {depth, width, 0.04}, wood);
  const Material metal = draw_material(rng, 0.15, 0.4, Texture::plain);
  for (const double x : {0.07, depth - 0.03}) {
    for (const double y : {-width / 2 + 0.05, width / 2 - 0.05}) {
      add_box(scene, place, {x, y, height / 2}, {0.05, 0.05, height - 0.04}, metal);
    }
  }
  add_box(scene, place, {0.2, uniform(rng, -0.3, 0.3), height + 0.22}, {0.05, 0.55, 0.36},
          draw_material(rng, 0.05, 0.15, Texture::plain));  // a screen
}

void add_furniture(Scene& scene, const Pose& place, int kind, std::mt19937_64& rng) {
  switch (kind % 4) {
    case 0:
      return add_table(scene, place, rng);
    case 1: {  // a cabinet or bookshelf
      const double height = uniform(rng, 1.2, 2.2);
      return add_box(
          scene, place, {0.23, 0, height / 2}, {0.42, uniform(rng, 0.7, 1.3), height},
          draw_material(rng, 0.2, 0.7, uniform(rng, 0, 1) < 0.5 ? Texture::stripes : Texture::plain));
    }
    case 2: {  // cardboard boxes
      const double edge = uniform(rng, 0.3, 0.55);
      const Material cardboard = draw_material(rng, 0.35, 0.55, Texture::blotches);
      add_box(scene, place, {0.35, 0, edge / 2}, {edge, edge * 1.3, edge}, cardboard);
      return add_box(scene, place, {0.33, 0.05, 1.3 * edge}, {0.8 * edge, edge, 0.6 * edge}, cardboard);
    }
    default: {  // a panel that leans on the wall
      const double height = uniform(rng, 0.6, 1.4);
      const Pose leaning{place.R * so3_exp({0, -0.2, 0}), place.t};
      return add_box(scene, leaning, {0.22 * height + 0.05, 0, height / 2},
                     {0.02, uniform(rng, 0.5, 0.9), height}, draw_material(rng, 0.3, 0.85, Texture::plain));
    }
  }
}

void add_poster(Scene& scene, const Pose& place, std::mt19937_64& rng) {
  add_box(scene, place, {0.005, 0, uniform(rng, 1.3, 1.8)},
          {0.01, uniform(rng, 0.4, 1.1), uniform(rng, 0.4, 0.8)},
          draw_material(rng, 0.1, 0.8, Texture::stripes));
}

}  // namespace

Scene furnish_room(const Room& room, std::uint64_t seed) {
  std::seed_seq seeds{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32), 0xF00Du};
  std::mt19937_64 rng(seeds);
  Scene scene;
  Solid walls;
  walls.shape = Shape::room;
  walls.T_rig_solid.t = {0, 0, room.height / 2 - room.rig_height};
  walls.size = {room.length / 2, room.width / 2, room.height / 2};
  walls.material = {0.62, 0.6, Texture::blotches, 0.9, 0.1};
  scene.add(walls);
  // The floor is a solid of its own, so that it can have its own material.
  add_box(scene, Pose{}, {0, 0, -room.rig_height - 0.01}, {room.length, room.width, 0.03},
          {0.36, 0.3, Texture::tiles, 0.5, 0.3});
  for (int i = 0; i < room.furniture; ++i) add_furniture(scene, draw_wall_place(room, rng), i, rng);
  for (int i = 0; i < room.furniture / 2; ++i) add_poster(scene, draw_wall_place(room, rng), rng);
  scene.lamp = {0.12 * room.length, 0.1 * room.width, room.height - room.rig_height - 0.1};
  return scene;
}

int add_board(Scene& scene, const Board& board, double bend, const Pose& T_rig_board) {
  Solid solid;
  solid.shape = Shape::plate;
  solid.T_rig_solid = T_rig_board;
  solid.plate = {board.extent(), bend};
  solid.print = &board;
  solid.material.albedo = 0.8;
  return scene.add(solid);
}

int add_panel(Scene& scene, const Board& board, const Pose& T_rig_panel, std::mt19937_64& rng) {
  Solid solid;
  solid.shape = Shape::plate;
  solid.T_rig_solid = T_rig_panel;
  solid.plate = {board.extent(), 0};
  solid.plate.outline.width *= uniform(rng, 0.93, 1.07);
  solid.plate.outline.height *= uniform(rng, 0.93, 1.07);
  solid.material = draw_material(rng, 0.4, 0.8, Texture::plain);
  return scene.add(solid);
}

}  // namespace ca2
