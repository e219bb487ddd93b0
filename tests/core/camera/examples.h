// Cameras of every model for the registry-wide tests: plain, realistic, wide, and with a distortion that
// folds.
#pragma once

#include <random>
#include <string>
#include <vector>

#include "core/camera/camera_model.h"

namespace ca2::test {

inline Camera make_camera(const char* model, int width, int height, const std::vector<double>& parameters) {
  Camera camera;
  camera.model = find_camera_model(model);
  camera.parameters =
      Eigen::Map<const Eigen::VectorXd>(parameters.data(), static_cast<Eigen::Index>(parameters.size()));
  camera.width = width;
  camera.height = height;
  return camera;
}

inline std::vector<Camera> example_cameras() {
  return {
      make_camera("pinhole_radtan", 640, 480, {500, 510, 320, 240, 0, 0, 0, 0}),
      make_camera("pinhole_radtan", 1388, 1038, {1100, 1103, 700, 512, -0.21, 0.11, 0.001, -0.0007, -0.02}),
      make_camera("pinhole_radtan", 1392, 512, {959, 957, 696, 224, -0.37, 0.2, 0.0013, 0.0017, -0.07}),
      make_camera("pinhole_radtan", 640, 480, {420, 421, 315, 243, 0.15, -0.3, -0.004, 0.002, 0.05}),
      make_camera("pinhole_radtan", 640, 480, {520, 520, 320, 240, -0.45, 0, 0.02, -0.01}),
      make_camera("pinhole_rational", 1280, 1024,
                  {610, 611, 638, 517, 5.2, 3.6, 0.0003, -0.0002, 0.21, 5.6, 5.4, 1.2}),
      make_camera("pinhole_rational", 1280, 720,
                  {640, 640, 642, 358, -0.3, 0.1, 0.001, 0.001, -0.01, 0.01, 0.02, -0.03}),
      make_camera("kannala_brandt", 848, 800, {286, 287, 418, 402, -0.0056, 0.041, -0.038, 0.0062}),
      make_camera("kannala_brandt", 1920, 1208,
                  {1176.93, 1177.72, 962.275, 612.725, -0.0540096, -0.0784275, 0.0959641, -0.0515253}),
      make_camera("kannala_brandt", 1000, 1000, {240, 240, 500, 500, 0, 0, 0, 0}),
      make_camera("double_sphere", 512, 512, {157, 157, 254, 256, -0.18, 0.59}),
      make_camera("double_sphere", 848, 800, {300, 301, 420, 405, 0.3, 0.75}),
      make_camera("double_sphere", 640, 480, {400, 400, 320, 240, 0.05, 0.2}),
      make_camera("double_sphere", 640, 480, {300, 300, 320, 240, 0.0, 0.5}),
  };
}

/// Name and parameters, for messages.
inline std::string describe(const Camera& camera) {
  std::string text(camera.model->name());
  for (const double p : camera.parameters) text += " " + std::to_string(p);
  return text;
}

inline Eigen::Vector2d random_pixel(const Camera& camera, std::mt19937_64& rng) {
  std::uniform_real_distribution<double> u(-0.5, camera.width - 0.5), v(-0.5, camera.height - 0.5);
  const double x = u(rng);
  return {x, v(rng)};
}

inline Eigen::Vector3d random_direction(std::mt19937_64& rng) {
  std::normal_distribution<double> normal;
  const double x = normal(rng), y = normal(rng);
  return Eigen::Vector3d(x, y, normal(rng)).normalized();
}

}  // namespace ca2::test
