#include <algorithm>
#include <cmath>

#include "tools/sim/camera_simulator.h"

namespace ca2 {
namespace {

constexpr int cell = 4;  // px between the rays that look for solids
constexpr int sub = 4;   // samples per pixel along silhouettes, squared

struct Sample {
  int surface = -1;
  float radiance = 0;
  float plate_light = 0;
};

class UnprintedRenderer {
 public:
  UnprintedRenderer(const RayGrid& rays, const Pose& T_rig_camera, const Scene& scene,
                    const PixelRegion& region, UnprintedPicture& picture)
      : rays_(rays), T_rig_camera_(T_rig_camera), scene_(scene), region_(region), picture_(picture) {
    surfaces_.resize(static_cast<std::size_t>(region.width()) * static_cast<std::size_t>(region.height()));
  }

  void run() {
    cast_nodes();
    shade_pixels();
    smooth_edges();
  }

 private:
  Eigen::Vector3d rig_direction(const Eigen::Vector3d& d) const { return (T_rig_camera_.R * d).normalized(); }

  /// What lies at the corners of every cell: few solids per cell remain to be cast at.
  void cast_nodes() {
    // With a cell more on every side, as gather_solids looks there.
    first_column_ = std::max(0, region_.x0 / cell - 1);
    first_row_ = std::max(0, region_.y0 / cell - 1);
    columns_ = std::min((region_.x1 - 1) / cell + 3, (picture_.width - 1) / cell + 2) - first_column_;
    rows_ = std::min((region_.y1 - 1) / cell + 3, (picture_.height - 1) / cell + 2) - first_row_;
    nodes_.resize(static_cast<std::size_t>(columns_) * rows_);
    for (int j = 0; j < rows_; ++j) {
      for (int i = 0; i < columns_; ++i) {
        const Eigen::Vector3d d = rays_.direction(std::min(cell * (first_column_ + i), picture_.width - 1),
                                                  std::min(cell * (first_row_ + j), picture_.height - 1));
        const SolidHit hit = std::isnan(d.x()) ? SolidHit{} : scene_.cast(T_rig_camera_.t, rig_direction(d));
        nodes_[static_cast<std::size_t>(j) * columns_ + i] = hit.surface();
      }
    }
  }

  /// Surfaces at the corners of the cells round a pixel, without repeats; from one cell further away where
  /// they differ, as a thin solid may pass between.
  void gather_solids(int x, int y, std::vector<int>& solids) const {
    const int i = x / cell - first_column_, j = y / cell - first_row_;
    const auto node = [&](int a, int b) {
      return nodes_[static_cast<std::size_t>(std::clamp(b, 0, rows_ - 1)) * columns_ +
                    std::clamp(a, 0, columns_ - 1)];
    };
    const int first = node(i, j);
    const bool uniform = first == node(i + 1, j) && first == node(i, j + 1) && first == node(i + 1, j + 1);
    const int reach = uniform ? 0 : 1;
    solids.clear();
    for (int b = j - reach; b <= j + 1 + reach; ++b) {
      for (int a = i - reach; a <= i + 1 + reach; ++a) {
        const int surface = node(a, b);
        if (surface >= 0 && std::find(solids.begin(), solids.end(), surface / 6) == solids.end()) {
          solids.push_back(surface / 6);
        }
      }
    }
  }

  Sample sample(const Eigen::Vector3d& direction_camera, const std::vector<int>& solids) const {
    if (std::isnan(direction_camera.x()) || solids.empty()) return {};
    const Eigen::Vector3d direction = rig_direction(direction_camera);
    const SolidHit hit = scene_.cast(T_rig_camera_.t, direction, solids);
    if (hit.solid < 0) return {};
    const Solid& solid = scene_.solids[static_cast<std::size_t>(hit.solid)];
    const double light = scene_.light(hit, scene_.normal(hit, direction));
    if (solid.print) {
      return {hit.surface(), static_cast<float>(paper_albedo * light), static_cast<float>(light)};
    }
    return {hit.surface(), static_cast<float>(solid.material.albedo * scene_.texture(hit) * light), 0};
  }

  void shade_pixels() {
    std::vector<Eigen::Vector3d> directions;
    std::vector<int> solids;
    for (int y = region_.y0; y < region_.y1; ++y) {
      rays_.row(region_.x0, region_.width(), y, directions);
      for (int x = region_.x0; x < region_.x1; ++x) {
        if (x % cell == 0 || x == region_.x0) gather_solids(x, y, solids);
        store(x, y, sample(directions[static_cast<std::size_t>(x - region_.x0)], solids));
      }
    }
  }

  void store(int x, int y, const Sample& sample) {
    surfaces_[surface_index(x, y)] = sample.surface;
    if (!inner(x, y)) return;
    const std::size_t i = static_cast<std::size_t>(y) * picture_.width + x;
    picture_.radiance[i] = sample.radiance;
    picture_.plate_light[i] = sample.plate_light;
  }

  std::size_t surface_index(int x, int y) const {
    return static_cast<std::size_t>(y - region_.y0) * static_cast<std::size_t>(region_.width()) +
           static_cast<std::size_t>(x - region_.x0);
  }

  /// Pixels on the region's rim do not know their neighbours beyond: they stay what they were.
  bool inner(int x, int y) const {
    return (x > region_.x0 || x == 0) && (y > region_.y0 || y == 0) &&
           (x < region_.x1 - 1 || x == picture_.width - 1) &&
           (y < region_.y1 - 1 || y == picture_.height - 1);
  }

  bool at_edge(int x, int y) const {
    const auto surface = [&](int a, int b) {
      return surfaces_[surface_index(std::clamp(a, region_.x0, region_.x1 - 1),
                                     std::clamp(b, region_.y0, region_.y1 - 1))];
    };
    const int own = surface(x, y);
    return own != surface(x - 1, y) || own != surface(x + 1, y) || own != surface(x, y - 1) ||
           own != surface(x, y + 1);
  }

  /// Pixels beside another surface become the mean of a grid of samples over their square.
  void smooth_edges() {
    std::vector<int> solids;
    for (int y = region_.y0; y < region_.y1; ++y) {
      for (int x = region_.x0; x < region_.x1; ++x) {
        if (!inner(x, y) || !at_edge(x, y)) continue;
        gather_solids(x, y, solids);
        // Neighbours may belong to the next cell.
        for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
          const int surface = surfaces_[surface_index(std::clamp(x + dx, region_.x0, region_.x1 - 1),
                                                      std::clamp(y + dy, region_.y0, region_.y1 - 1))];
          if (surface >= 0 && std::find(solids.begin(), solids.end(), surface / 6) == solids.end()) {
            solids.push_back(surface / 6);
          }
        }
        float radiance = 0, plate_light = 0;
        for (int k = 0; k < sub * sub; ++k) {
          const double u = x + (k % sub + 0.5) / sub - 0.5, v = y + (k / sub + 0.5) / sub - 0.5;
          const Sample part = sample(rays_.direction(u, v), solids);
          radiance += part.radiance / (sub * sub);
          plate_light += part.plate_light / (sub * sub);
        }
        const std::size_t i = static_cast<std::size_t>(y) * picture_.width + x;
        picture_.radiance[i] = radiance;
        picture_.plate_light[i] = plate_light;
      }
    }
  }

  const RayGrid& rays_;
  const Pose& T_rig_camera_;
  const Scene& scene_;
  const PixelRegion& region_;
  UnprintedPicture& picture_;
  std::vector<int> surfaces_;  ///< of the region's pixels
  std::vector<int> nodes_;
  int first_column_ = 0, first_row_ = 0, columns_ = 0, rows_ = 0;
};

}  // namespace

void render_unprinted(const RayGrid& rays, const Pose& T_rig_camera, const Scene& scene,
                      const PixelRegion& region, UnprintedPicture& picture) {
  if (region.width() <= 0 || region.height() <= 0) return;
  UnprintedRenderer(rays, T_rig_camera, scene, region, picture).run();
}

UnprintedPicture render_unprinted(const RayGrid& rays, const Pose& T_rig_camera, const Scene& scene) {
  UnprintedPicture picture;
  picture.width = rays.camera().width;
  picture.height = rays.camera().height;
  const auto pixels = static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height);
  picture.radiance.resize(pixels);
  picture.plate_light.resize(pixels);
  render_unprinted(rays, T_rig_camera, scene, {0, 0, picture.width, picture.height}, picture);
  return picture;
}

}  // namespace ca2
