/// @file What a camera sees of a scene.
#pragma once

#include <functional>
#include <random>
#include <vector>

#include "core/types/image.h"
#include "tools/sim/ray_grid.h"
#include "tools/sim/scenario.h"
#include "tools/sim/scene.h"

namespace ca2 {

/// A grey picture. The print of a plate is exact: every pixel is the ideal print through the camera's true
/// projection, averaged over the pixel's square and a Gaussian of CameraNoise::blur; the scene behind is
/// anti-aliased along its silhouettes. Then vignetting, noise and quantisation. `rays` belongs to the camera.
Image render_picture(const SimulatedCamera& camera, const RayGrid& rays, const Scene& scene,
                     std::mt19937_64& rng);

/// The scene as if nothing were printed on any plate, before the lens blurs it.
struct UnprintedPicture {
  int width = 0, height = 0;
  std::vector<float> radiance;     ///< 1: exposes to full scale
  std::vector<float> plate_light;  ///< light on the printed plate times the share of the pixel it fills
};

/// Pixels with x0 <= x < x1 and y0 <= y < y1.
struct PixelRegion {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
};

/// Point samples inside surfaces, 4 x 4 samples where silhouettes and edges pass.
UnprintedPicture render_unprinted(const RayGrid& rays, const Pose& T_rig_camera, const Scene& scene);
/// Renders a region of the picture anew; what is on its rim must not have changed.
void render_unprinted(const RayGrid& rays, const Pose& T_rig_camera, const Scene& scene,
                      const PixelRegion& region, UnprintedPicture& picture);

/// Gaussian blur of `sigma` px along rows and columns, the rim repeated.
void blur_picture(std::vector<float>& pixels, int width, int height, double sigma);

/// Vignetting, noise and quantisation. `noise` gives draws of the normal distribution.
Image expose(const std::vector<float>& radiance, const SimulatedCamera& camera,
             const std::function<float()>& noise);

/// Adds the print: what its ink takes away from the radiance of the paper, blurred exactly.
void subtract_print(const RayGrid& rays, const Pose& T_camera_plate, const Solid& plate, double blur,
                    const std::vector<float>& plate_light, std::vector<float>& radiance);

/// In visible light.
inline constexpr double paper_albedo = 0.8;
inline constexpr double ink_albedo = 0.06;

}  // namespace ca2
