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
  UnprintedRenderer(const RayGrid& rays, const Pose& T_rig_camera, const Scene& scene)
      : rays_(rays), T_rig_camera_(T_rig_camera), scene_(scene) {
    picture_.width = rays.camera().width;
    picture_.height = rays.camera().height;
    const auto pixels = static_cast<std::size_t>(picture_.width) * static_cast<std::size_t>(picture_.height);
    picture_.radiance.resize(pixels);
    picture_.plate_light.resize(pixels);
    surfaces_.resize(pixels);
  }

  UnprintedPicture run() {
    cast_nodes();
    shade_pixels();
    smooth_edges();
    return std::move(picture_);
  }

 private:
  Eigen::Vector3d rig_direction(const Eigen::Vector3d& d) const { return (T_rig_camera_.R * d).normalized(); }

  /// What lies at the corners of every cell: few solids per cell remain to be cast at.
  void cast_nodes() {
    columns_ = (picture_.width - 1) / cell + 2;
    rows_ = (picture_.height - 1) / cell + 2;
    nodes_.resize(static_cast<std::size_t>(columns_) * rows_);
    std::vector<Eigen::Vector3d> directions;
    for (int j = 0; j < rows_; ++j) {
      for (int i = 0; i < columns_; ++i) {
        const Eigen::Vector3d d =
            rays_.direction(std::min(cell * i, picture_.width - 1), std::min(cell * j, picture_.height - 1));
        const SolidHit hit = std::isnan(d.x()) ? SolidHit{} : scene_.cast(T_rig_camera_.t, rig_direction(d));
        nodes_[static_cast<std::size_t>(j) * columns_ + i] = hit.surface();
      }
    }
  }

  /// Surfaces at the corners of the cells round a pixel, without repeats; from one cell further away where
  /// they differ, as a thin solid may pass between.
  void gather_solids(int x, int y, std::vector<int>& solids) const {
    const int i = x / cell, j = y / cell;
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
    for (int y = 0; y < picture_.height; ++y) {
      rays_.row(0, picture_.width, y, directions);
      for (int x = 0; x < picture_.width; ++x) {
        if (x % cell == 0) gather_solids(x, y, solids);
        store(x, y, sample(directions[static_cast<std::size_t>(x)], solids));
      }
    }
  }

  void store(int x, int y, const Sample& sample) {
    const std::size_t i = static_cast<std::size_t>(y) * picture_.width + x;
    picture_.radiance[i] = sample.radiance;
    picture_.plate_light[i] = sample.plate_light;
    surfaces_[i] = sample.surface;
  }

  bool at_edge(int x, int y) const {
    const auto surface = [&](int a, int b) {
      return surfaces_[static_cast<std::size_t>(std::clamp(b, 0, picture_.height - 1)) * picture_.width +
                       std::clamp(a, 0, picture_.width - 1)];
    };
    const int own = surface(x, y);
    return own != surface(x - 1, y) || own != surface(x + 1, y) || own != surface(x, y - 1) ||
           own != surface(x, y + 1);
  }

  /// Pixels beside another surface become the mean of a grid of samples over their square.
  void smooth_edges() {
    std::vector<int> solids;
    for (int y = 0; y < picture_.height; ++y) {
      for (int x = 0; x < picture_.width; ++x) {
        if (!at_edge(x, y)) continue;
        gather_solids(x, y, solids);
        // Neighbours may belong to the next cell.
        for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
          const int nx = std::clamp(x + dx, 0, picture_.width - 1);
          const int ny = std::clamp(y + dy, 0, picture_.height - 1);
          const int surface = surfaces_[static_cast<std::size_t>(ny) * picture_.width + nx];
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
  UnprintedPicture picture_;
  std::vector<int> surfaces_;
  std::vector<int> nodes_;
  int columns_ = 0, rows_ = 0;
};

}  // namespace

UnprintedPicture render_unprinted(const RayGrid& rays, const Pose& T_rig_camera, const Scene& scene) {
  return UnprintedRenderer(rays, T_rig_camera, scene).run();
}

}  // namespace ca2
