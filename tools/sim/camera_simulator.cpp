#include "tools/sim/camera_simulator.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace ca2 {

void blur_picture(std::vector<float>& pixels, int width, int height, double sigma) {
  if (sigma <= 0) return;
  const int reach = std::max(1, static_cast<int>(std::ceil(3.5 * sigma)));
  std::vector<float> weights;
  float sum = 0;
  for (int k = -reach; k <= reach; ++k) {
    weights.push_back(static_cast<float>(std::exp(-0.5 * k * k / (sigma * sigma))));
    sum += weights.back();
  }
  for (float& weight : weights) weight /= sum;
  const auto w = static_cast<std::size_t>(width), r = static_cast<std::size_t>(reach);
  std::vector<float> padded(w + 2 * r);
  for (int y = 0; y < height; ++y) {
    float* row = pixels.data() + static_cast<std::size_t>(y) * w;
    std::copy(row, row + w, padded.begin() + reach);
    std::fill(padded.begin(), padded.begin() + reach, row[0]);
    std::fill(padded.end() - reach, padded.end(), row[w - 1]);
    std::fill(row, row + w, 0.0f);
    for (std::size_t k = 0; k < weights.size(); ++k) {
      for (std::size_t x = 0; x < w; ++x) row[x] += weights[k] * padded[x + k];
    }
  }
  const std::vector<float> source = pixels;
  std::fill(pixels.begin(), pixels.end(), 0.0f);
  for (int y = 0; y < height; ++y) {
    float* out = pixels.data() + static_cast<std::size_t>(y) * w;
    for (int k = -reach; k <= reach; ++k) {
      const float* in = source.data() + static_cast<std::size_t>(std::clamp(y + k, 0, height - 1)) * w;
      for (std::size_t x = 0; x < w; ++x) out[x] += weights[static_cast<std::size_t>(k + reach)] * in[x];
    }
  }
}

Image expose(const std::vector<float>& radiance, const SimulatedCamera& camera,
             const std::function<float()>& noise) {
  const auto& [width, height] = std::pair(camera.camera.width, camera.camera.height);
  Image image{width, height, 1, camera.noise.bits, {}};
  image.bytes.resize(radiance.size() * image.bytes_per_pixel());
  const double half_diagonal_squared = 0.25 * (static_cast<double>(width) * width + height * height);
  const float full = image.bits == 8 ? 255.0f : 65535.0f;
  const auto sigma = static_cast<float>(camera.noise.sigma);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * width + x;
      const double dx = x - (width - 1) / 2.0, dy = y - (height - 1) / 2.0;
      const double falloff = 1 - camera.noise.vignetting * (dx * dx + dy * dy) / half_diagonal_squared;
      const float value = radiance[i] * static_cast<float>(falloff) + sigma * noise();
      const auto level = static_cast<std::uint16_t>(std::lround(full * std::clamp(value, 0.0f, 1.0f)));
      if (image.bits == 8) {
        image.bytes[i] = static_cast<std::uint8_t>(level);
      } else {
        std::memcpy(image.bytes.data() + 2 * i, &level, 2);
      }
    }
  }
  return image;
}

Image render_picture(const SimulatedCamera& camera, const RayGrid& rays, const Scene& scene,
                     std::mt19937_64& rng) {
  UnprintedPicture picture = render_unprinted(rays, camera.T_rig_camera, scene);
  // The unprinted scene is smooth enough to be blurred at the pixels' spacing; the print is not.
  blur_picture(picture.radiance, picture.width, picture.height, camera.noise.blur);
  for (const Solid& solid : scene.solids) {
    if (!solid.print) continue;
    subtract_print(rays, camera.T_rig_camera.inverse() * solid.T_rig_solid, solid, camera.noise.blur,
                   picture.plate_light, picture.radiance);
  }
  std::normal_distribution<float> normal;
  return expose(picture.radiance, camera, [&] { return normal(rng); });
}

}  // namespace ca2
