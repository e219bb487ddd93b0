/// @file Calibrations to export: a rig of two cameras and two LiDARs, any poses.
#pragma once

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include <map>
#include <set>

#include "core/export/exporter.h"

namespace ca2::test {

inline Camera example_camera(const char* model, std::vector<double> shape) {
  std::vector<double> p{612.3456789012345, 611.1, 320.25, 239.75};
  p.insert(p.end(), shape.begin(), shape.end());
  return {find_camera_model(model),
          Eigen::Map<Eigen::VectorXd>(p.data(), static_cast<Eigen::Index>(p.size())), 640, 480};
}

/// Poses of the sensors in the first camera's frame. From the third on, the pitch of T_left_top is 90 degrees
/// as nearly as a double can say, and then by ever more away from it.
inline Pose example_pose(int index, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const Eigen::Vector3d t(normal(random), normal(random), 1e-3 * normal(random));
  if (index < 20) {
    return Pose::from_quaternion(
        Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random)).normalized(), t);
  }
  const double off = index == 20 ? 0 : std::pow(10.0, index - 37);
  const Eigen::AngleAxisd pitch((index % 2 ? -1 : 1) * std::numbers::pi / 2 + off, Eigen::Vector3d::UnitY());
  return {(Eigen::AngleAxisd(normal(random), Eigen::Vector3d::UnitZ()) * pitch *
           Eigen::AngleAxisd(normal(random), Eigen::Vector3d::UnitX()))
              .toRotationMatrix(),
          t};
}
inline constexpr int example_poses = 36;

struct Example {
  ExportRequest request;
  Pose T_left_right, T_left_top, T_left_side;
};

inline Example example(int index = 0) {
  std::mt19937_64 random(100 + static_cast<unsigned>(index));
  Example e;
  e.T_left_right = example_pose(0, random);
  e.T_left_top = example_pose(index, random);
  e.T_left_side = example_pose(1, random);
  Calibration& c = e.request.calibration;
  c.software = "ca2 0.1.0";
  c.method = "joint";
  c.observability = {"good", "rotation about the vertical", 12};
  c.cameras["left"] = {example_camera("pinhole_radtan", {-0.1, 0.05, 1e-4, -2e-4}), false, {}};
  c.cameras["right"] = {example_camera("kannala_brandt", {0.01, -0.002, 3e-4, -1e-5}), false, {}};
  const Matrix6d covariance = 1e-6 * Matrix6d::Identity();
  const auto add = [&](const char* parent, const char* child, const Pose& T) {
    const auto frame = [&](const std::string& name) {
      return name + (c.cameras.count(name) ? "_camera_optical" : "_lidar");
    };
    c.transforms.push_back({parent, child, frame(parent), frame(child), T, covariance});
  };
  add("left", "top", e.T_left_top);
  add("left", "side", e.T_left_side);
  add("right", "top", e.T_left_right.inverse() * e.T_left_top);
  add("right", "side", e.T_left_right.inverse() * e.T_left_side);
  add("left", "right", e.T_left_right);
  c.lidars["top"] = {};
  c.lidars["side"] = {};
  c.views = {{1, true, "", 0.1, 0.002}, {2, false, "no board", 0, 0}};
  e.request.session = "rig -- one";
  e.request.provenance = {{"lidars.top.serial", "122"}};
  const auto frames = FrameGraph::of(c);
  EXPECT_TRUE(frames) << frames.error().text();
  if (frames) e.request.frames = *frames;
  return e;
}

/// The file of that name that the exporter wrote; fails the test where it did not.
inline std::string exported(const ExportRequest& request, const char* format, const std::string& name) {
  const auto files = find_exporter(format)->write(request);
  if (!files) {
    ADD_FAILURE() << files.error().text();
    return {};
  }
  for (const ExportFile& file : *files) {
    if (file.name == name) return file.content;
  }
  ADD_FAILURE() << format << " wrote no " << name;
  return {};
}

/// Every number of the two poses' matrices to 1e-9.
inline void expect_same(const Pose& found, const Pose& truth) {
  EXPECT_LT((found.R - truth.R).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LT((found.t - truth.t).cwiseAbs().maxCoeff(), 1e-9);
}

/// R = Rz Ry Rx written out: the readers' own arithmetic, not the exporters'.
inline Eigen::Matrix3d urdf_rotation(double r, double p, double y) {
  Eigen::Matrix3d Rx, Ry, Rz;
  Rx << 1, 0, 0, 0, std::cos(r), -std::sin(r), 0, std::sin(r), std::cos(r);
  Ry << std::cos(p), 0, std::sin(p), 0, 1, 0, -std::sin(p), 0, std::cos(p);
  Rz << std::cos(y), -std::sin(y), 0, std::sin(y), std::cos(y), 0, 0, 0, 1;
  return Rz * Ry * Rx;
}

/// The matrix of a unit quaternion, written out.
inline Eigen::Matrix3d quaternion_rotation(double x, double y, double z, double w) {
  Eigen::Matrix3d R;
  R << 1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w),  //
      2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w),   //
      2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y);
  return R;
}

}  // namespace ca2::test
