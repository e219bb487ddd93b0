#include "tools/sim/picture_sequence.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace ca2 {
namespace {

constexpr int spacing = 8;              // px between the directions that look for what moves
constexpr std::size_t draws = 1 << 20;  // of noise

/// A part of the picture's pixels.
std::vector<float> cut(const std::vector<float>& pixels, int width, const PixelRegion& region) {
  std::vector<float> part;
  part.reserve(static_cast<std::size_t>(region.width()) * static_cast<std::size_t>(region.height()));
  for (int y = region.y0; y < region.y1; ++y) {
    const auto row = pixels.begin() + static_cast<std::ptrdiff_t>(y) * width;
    part.insert(part.end(), row + region.x0, row + region.x1);
  }
  return part;
}

}  // namespace

PictureSequence::PictureSequence(const SimulatedCamera& camera, const Scene& room)
    : camera_(camera),
      rays_(camera.camera),
      room_solids_(room.solids.size()),
      room_(render_unprinted(rays_, camera.T_rig_camera, room)),
      blurred_room_(room_.radiance),
      columns_(camera.camera.width / spacing + 1),
      rows_(camera.camera.height / spacing + 1) {
  blur_picture(blurred_room_, room_.width, room_.height, camera.noise.blur);
  for (int j = 0; j < rows_; ++j) {
    for (int i = 0; i < columns_; ++i) {
      const Eigen::Vector3d d =
          rays_.direction(std::min(spacing * i, room_.width - 1), std::min(spacing * j, room_.height - 1));
      directions_.push_back((camera.T_rig_camera.R * d).normalized().cast<float>());
    }
  }
  std::mt19937_64 rng(1);
  std::normal_distribution<float> normal;
  for (std::size_t i = 0; i < draws; ++i) noise_.push_back(normal(rng));
}

PixelRegion PictureSequence::region_of(const Scene& scene) const {
  int x0 = columns_, x1 = -1, y0 = rows_, y1 = -1;
  for (std::size_t s = room_solids_; s < scene.solids.size(); ++s) {
    const Solid& solid = scene.solids[s];
    const Eigen::Vector3d to = solid.T_rig_solid.t - camera_.T_rig_camera.t;
    const double distance = to.norm(), radius = solid.bounding_radius;
    const float cosine =
        distance > radius ? static_cast<float>(std::sqrt(1 - radius * radius / (distance * distance))) : -1;
    const Eigen::Vector3f axis = (to / distance).cast<float>();
    for (int j = 0; j < rows_; ++j) {
      for (int i = 0; i < columns_; ++i) {
        // False for a place the camera has no direction for.
        if (!(directions_[static_cast<std::size_t>(j * columns_ + i)].dot(axis) >= cosine)) continue;
        x0 = std::min(x0, i), x1 = std::max(x1, i), y0 = std::min(y0, j), y1 = std::max(y1, j);
      }
    }
  }
  if (x1 < 0) return {};
  return {std::max(0, spacing * (x0 - 1)), std::max(0, spacing * (y0 - 1)),
          std::min(room_.width, spacing * (x1 + 2)), std::min(room_.height, spacing * (y1 + 2))};
}

Image PictureSequence::render(const Scene& scene, std::uint64_t seed) {
  const PixelRegion moving = region_of(scene);
  UnprintedPicture picture = room_;
  render_unprinted(rays_, camera_.T_rig_camera, scene, moving, picture);
  std::vector<float> radiance = blurred_room_;
  if (moving.width() > 0) {
    // The lens spreads what moves a little beyond its region, and what is beyond into it.
    const int reach = static_cast<int>(std::ceil(3.5 * camera_.noise.blur)) + 1;
    const auto grown = [&](int by) {
      return PixelRegion{std::max(0, moving.x0 - by), std::max(0, moving.y0 - by),
                         std::min(room_.width, moving.x1 + by), std::min(room_.height, moving.y1 + by)};
    };
    const PixelRegion wide = grown(2 * reach), changed = grown(reach);
    std::vector<float> part = cut(picture.radiance, room_.width, wide);
    blur_picture(part, wide.width(), wide.height(), camera_.noise.blur);
    for (int y = changed.y0; y < changed.y1; ++y) {
      const auto from = part.begin() + static_cast<std::ptrdiff_t>(y - wide.y0) * wide.width() - wide.x0;
      std::copy(from + changed.x0, from + changed.x1,
                radiance.begin() + static_cast<std::ptrdiff_t>(y) * room_.width + changed.x0);
    }
  }
  for (const Solid& solid : scene.solids) {
    if (!solid.print) continue;
    subtract_print(rays_, camera_.T_rig_camera.inverse() * solid.T_rig_solid, solid, camera_.noise.blur,
                   picture.plate_light, radiance);
  }
  std::mt19937_64 rng(seed);
  std::size_t at = 0, left = 0;
  return expose(radiance, camera_, [&] {
    if (left == 0) {
      at = rng() % (draws - 4096);
      left = 4096;
    }
    --left;
    return noise_[at++];
  });
}

}  // namespace ca2
