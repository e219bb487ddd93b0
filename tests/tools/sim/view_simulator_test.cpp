#include "tools/sim/view_simulator.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "core/geometry/plane.h"
#include "tests/tools/sim/test_rigs.h"
#include "tools/sim/camera_simulator.h"

namespace ca2 {
namespace {

std::uint16_t level(const Image& image, int x, int y) {
  std::uint16_t value = 0;
  std::memcpy(&value, image.bytes.data() + 2 * (static_cast<std::size_t>(y) * image.width + x), 2);
  return value;
}

Scenario noise_free(Scenario scenario) {
  for (auto& [name, camera] : scenario.cameras) {
    camera.noise.sigma = 0;
    camera.noise.bits = 16;
    camera.noise.vignetting = 0;
  }
  for (auto& [name, lidar] : scenario.lidars) {
    lidar.noise.range_sigma = 0;
    lidar.noise.dropout = 0;
    lidar.beams.range_quantum = 0;
  }
  return scenario;
}

SimulatedCamera fisheye() {
  SimulatedCamera camera;
  camera.camera.model = find_camera_model("kannala_brandt");
  camera.camera.parameters.resize(8);
  camera.camera.parameters << 286.2, 286.1, 421.9, 399.4, -0.0067, 0.0419, -0.0386, 0.0064;
  camera.camera.width = 848;
  camera.camera.height = 800;
  camera.noise.blur = 0.6;
  return camera;
}

TEST(RayGrid, InterpolatesTheDirectionsOfBothKindsOfLens) {
  for (const Camera& camera : {small_scenario().cameras.at("front").camera, fisheye().camera}) {
    const RayGrid grid(camera);
    std::mt19937_64 rng(1);
    double worst = 0;
    for (int i = 0; i < 3000; ++i) {
      const double u = std::uniform_real_distribution<double>(-0.5, camera.width - 0.5)(rng);
      const double v = std::uniform_real_distribution<double>(-0.5, camera.height - 0.5)(rng);
      const Eigen::Vector3d direction = grid.direction(u, v);
      // The specified field of view; beyond it this lens's polynomial comes near to its turning point.
      if (!(std::atan2(direction.head<2>().norm(), direction.z()) < 1.42)) continue;
      const auto pixel = camera.project(direction);
      ASSERT_TRUE(pixel);
      worst = std::max(worst, (*pixel - Eigen::Vector2d(u, v)).norm());
    }
    std::printf("ray grid: worst %.2e px\n", worst);
    EXPECT_LT(worst, 1e-4);
  }
}

/// The value of a pixel by brute force: the print through the true inverse projection, weighted with the
/// pixel's square convolved with the Gaussian.
double oracle_share(const Camera& camera, const Board& board, const Pose& T_camera_board, double blur, int x,
                    int y) {
  constexpr int steps = 160;
  const double reach = 0.5 + 4.5 * blur;
  const Pose T_board_camera = T_camera_board.inverse();
  double sum = 0, weights = 0;
  const auto weight = [&](double d) {
    return std::erf((d + 0.5) / (std::sqrt(2.0) * blur)) - std::erf((d - 0.5) / (std::sqrt(2.0) * blur));
  };
  for (int j = 0; j < steps; ++j) {
    for (int i = 0; i < steps; ++i) {
      const double dx = reach * (2 * (i + 0.5) / steps - 1), dy = reach * (2 * (j + 0.5) / steps - 1);
      const Eigen::Vector3d d = T_board_camera.R * *camera.unproject({x + dx, y + dy});
      const Eigen::Vector3d p = T_board_camera.t - T_board_camera.t.z() / d.z() * d;
      const double w = weight(dx) * weight(dy);
      weights += w;
      if (board.type->black(board, p.head<2>())) sum += w;
    }
  }
  return sum / weights;
}

TEST(CameraSimulator, ThePrintIsTheIdealOneThroughTheLens) {
  const Scenario scenario = small_scenario();
  for (const auto& [sensor, distance] :
       {std::pair(scenario.cameras.at("front"), 2.2), std::pair(fisheye(), 1.1)}) {
    const RayGrid rays(sensor.camera);
    Solid plate;
    plate.shape = Shape::plate;
    plate.plate = {scenario.board.extent(), 0};
    plate.print = &scenario.board;
    const Pose T_camera_board{so3_exp({0.5, -0.4, 0.3}), {0.25, -0.15, distance}};
    const auto pixels = static_cast<std::size_t>(sensor.camera.width) * sensor.camera.height;
    std::vector<float> radiance(pixels, 0);
    subtract_print(rays, T_camera_board, plate, sensor.noise.blur, std::vector<float>(pixels, 1), radiance);
    double square = 0, worst = 0;
    int count = 0;
    for (const Eigen::Vector2d& corner : scenario.board.type->corners(scenario.board)) {
      if (count >= 4 * 25) break;
      const Eigen::Vector2d pixel =
          *sensor.camera.project(T_camera_board * Eigen::Vector3d(corner.x(), corner.y(), 0));
      for (int dy = -2; dy <= 2; ++dy) {
        for (int dx = -2; dx <= 2; ++dx) {
          const int x = static_cast<int>(std::lround(pixel.x())) + dx;
          const int y = static_cast<int>(std::lround(pixel.y())) + dy;
          const double rendered =
              -radiance[static_cast<std::size_t>(y) * sensor.camera.width + x] / (paper_albedo - ink_albedo);
          const double truth =
              oracle_share(sensor.camera, scenario.board, T_camera_board, sensor.noise.blur, x, y);
          square += (rendered - truth) * (rendered - truth);
          worst = std::max(worst, std::abs(rendered - truth));
          ++count;
        }
      }
    }
    std::printf("print against brute force, share of ink: rms %.5f, worst %.5f\n", std::sqrt(square / count),
                worst);
    EXPECT_LT(std::sqrt(square / count), 0.0006);
    EXPECT_LT(worst, 0.002);
  }
}

TEST(CameraSimulator, CornersAreWhereTheTruthSays) {
  Scenario scenario = noise_free(small_scenario());
  scenario.placement.max_tilt = 0.5;
  const ViewSimulator simulator(scenario);
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  double square = 0;
  int count = 0;
  for (int id = 1; id <= 4; ++id) {
    const auto view = simulator.render(id);
    ASSERT_TRUE(view) << view.error().text();
    const Image& image = view->images.at("front");
    cv::Mat grey(image.height, image.width, CV_8U);
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        grey.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(level(image, x, y) / 257);
      }
    }
    for (const Eigen::Vector2d& corner : scenario.board.type->corners(scenario.board)) {
      const Eigen::Vector2d truth = *scenario.cameras.at("front").camera.project(
          view->T_sensor_board.at("front") * Eigen::Vector3d(corner.x(), corner.y(), 0));
      std::vector<cv::Point2f> found{
          {static_cast<float>(truth.x() + 0.4), static_cast<float>(truth.y() - 0.3)}};
      cv::cornerSubPix(grey, found, {4, 4}, {-1, -1},
                       {cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 60, 1e-4});
      const Eigen::Vector2d error = Eigen::Vector2d(found[0].x, found[0].y) - truth;
      mean += error;
      square += error.squaredNorm();
      ++count;
    }
  }
  mean /= count;
  std::printf("cornerSubPix against truth: mean (%.4f, %.4f) px, rms %.4f px\n", mean.x(), mean.y(),
              std::sqrt(square / (2 * count)));
  // OpenCV's own model error is a few hundredths of a pixel; half a pixel of shift would be the simulator's.
  EXPECT_LT(mean.norm(), 0.015);
  EXPECT_LT(std::sqrt(square / (2 * count)), 0.06);
}

TEST(CameraSimulator, PhotometricCornersOfANoisyPictureHaveNoBias) {
  const Scenario scenario = small_scenario();
  const ViewSimulator simulator(scenario);
  const std::vector<Eigen::Vector2d> model = scenario.board.type->corners(scenario.board);
  for (int id = 1; id <= 2; ++id) {
    const auto view = simulator.render(id);
    ASSERT_TRUE(view) << view.error().text();
    const std::vector<Corner> corners = detect_board(scenario.board, view->images.at("front"));
    ASSERT_EQ(corners.size(), model.size());
    // 8 x 6 corners look the same after half a turn: the better of the two numberings counts.
    double best = std::numeric_limits<double>::max();
    Eigen::Vector2d bias = Eigen::Vector2d::Zero();
    for (const double sign : {1.0, -1.0}) {
      double square = 0;
      Eigen::Vector2d sum = Eigen::Vector2d::Zero();
      for (const Corner& corner : corners) {
        const Eigen::Vector2d p = sign * model[static_cast<std::size_t>(corner.id)];
        const Eigen::Vector2d error =
            corner.pixel - *scenario.cameras.at("front").camera.project(view->T_sensor_board.at("front") *
                                                                        Eigen::Vector3d(p.x(), p.y(), 0));
        square += error.squaredNorm();
        sum += error;
      }
      if (square < best) {
        best = square;
        bias = sum / static_cast<double>(corners.size());
      }
    }
    const double rms = std::sqrt(best / (2.0 * static_cast<double>(corners.size())));
    std::printf("detect_board against truth: mean (%.4f, %.4f) px, rms %.4f px\n", bias.x(), bias.y(), rms);
    EXPECT_LT(bias.norm(), 0.008);
    EXPECT_LT(rms, 0.03);
  }
}

TEST(LidarSimulator, NoiseFreeReturnsLieOnTheBoard) {
  Scenario scenario = noise_free(small_scenario());
  scenario.lidars.at("top").noise.divergence = 0;
  const ViewSimulator simulator(scenario);
  const auto view = simulator.render(1);
  ASSERT_TRUE(view) << view.error().text();
  const Pose T_board_lidar = view->T_sensor_board.at("top").inverse();
  const Plate plate{scenario.board.extent(), 0};
  const Scan& scan = view->scans.at("top");
  ASSERT_EQ(scan.range.size(), scan.size());
  ASSERT_EQ(scan.ring.size(), scan.size());
  int on_board = 0, covered = 0;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const Eigen::Vector3d p = T_board_lidar * scan.points[i].cast<double>();
    const Eigen::Vector3d origin = T_board_lidar.t;
    const auto t = plate.intersect(origin, (p - origin).normalized());
    if (!t || *t > (p - origin).norm() + 0.5) continue;
    // The beam meets the plate: what it returns lies on it, or on the hand in front of it.
    if (std::abs(p.z()) < 1e-6) {
      ++on_board;
    } else {
      ++covered;
      EXPECT_LT(p.z(), 0);
      EXPECT_GT(p.z(), -0.06);
      EXPECT_FALSE(plate.contains(p.head<2>(), scenario.room->hand_cover + 0.03));
    }
  }
  EXPECT_GT(on_board, 50);
  EXPECT_LT(covered, on_board / 5);
  // Every beam ends somewhere in a closed room.
  EXPECT_GT(scan.size(), 0.97 * static_cast<double>(scenario.lidars.at("top").beams.rays.size()));
}

TEST(LidarSimulator, WideBeamsBlendSurfacesAtTheRimOnly) {
  Scenario scenario = noise_free(small_scenario());
  scenario.lidars.at("top").noise.divergence = 0.01;
  scenario.lidars.at("top").noise.pulse_length = 5;
  const ViewSimulator simulator(scenario);
  const auto view = simulator.render(2);
  ASSERT_TRUE(view) << view.error().text();
  const Plane plane = board_plane(view->T_sensor_board.at("top"));
  const Pose T_board_lidar = view->T_sensor_board.at("top").inverse();
  const Outline outline = scenario.board.extent();
  int blended = 0;
  for (const Eigen::Vector3f& point : view->scans.at("top").points) {
    const Eigen::Vector3d p = T_board_lidar * point.cast<double>();
    const Eigen::Vector2d inside =
        Eigen::Vector2d(outline.width, outline.height) / 2 - (p.head<2>() - outline.center).cwiseAbs();
    // Behind the plate, well before what is behind it, within a footprint of the rim.
    const double off = -plane.distance(point.cast<double>());
    if (inside.minCoeff() > -0.02 && inside.minCoeff() < 0.04 && off > 0.02 && off < 0.6) ++blended;
    if (inside.minCoeff() > 0.12 && std::abs(p.z()) < 0.02) {
      EXPECT_NEAR(p.z(), 0, 1e-6);
    }
  }
  EXPECT_GT(blended, 3);
}

TEST(ViewSimulator, AWrongViewsScanIsOfAnotherPlace) {
  for (const WrongObject kind : {WrongObject::moved, WrongObject::panel}) {
    Scenario scenario = noise_free(small_scenario());
    scenario.wrong_fraction = 1;
    scenario.wrong_object = kind;
    const ViewSimulator simulator(scenario);
    const auto view = simulator.render(1);
    ASSERT_TRUE(view) << view.error().text();
    EXPECT_EQ(view->wrong_object, kind);
    const Pose T_board_lidar = view->T_sensor_board.at("top").inverse();
    const Plate plate{scenario.board.extent(), 0};
    int on_board = 0;
    for (const Eigen::Vector3f& point : view->scans.at("top").points) {
      const Eigen::Vector3d p = T_board_lidar * point.cast<double>();
      if (plate.contains(p.head<2>(), 0.05) && std::abs(p.z()) < 1e-5) ++on_board;
    }
    // A panel stands beside the board; a moved board is gone.
    if (kind == WrongObject::moved) {
      EXPECT_LT(on_board, 10);
    } else {
      EXPECT_GT(on_board, 30);
    }
  }
}

TEST(ViewSimulator, TheSameViewIsTheSameToTheLastBit) {
  const Scenario scenario = small_scenario();
  const ViewSimulator one(scenario), other(scenario);
  (void)one.render(1);
  const auto a = one.render(3), b = other.render(3);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->images.at("front").bytes, b->images.at("front").bytes);
  EXPECT_EQ(a->scans.at("top").points, b->scans.at("top").points);
  EXPECT_EQ(a->scans.at("top").intensity, b->scans.at("top").intensity);
}

}  // namespace
}  // namespace ca2
