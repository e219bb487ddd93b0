// Intrinsics from simulated corners, against truth, against sampling and against OpenCV.
#include "core/camera/estimate_intrinsics.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <opencv2/calib3d.hpp>

#include "tests/core/camera/simulated_views.h"

namespace ca2 {
namespace {

using test::checkerboard;
using test::simulate_views;

std::vector<Camera> true_cameras() {
  return {
      test::make_camera("pinhole_radtan", 1388, 1038,
                        {1100, 1103, 700, 512, -0.21, 0.11, 0.001, -0.0007, -0.02}),
      test::make_camera("pinhole_radtan", 640, 480, {1500, 1510, 315, 250, -0.3, 0.2, 0.001, 0.002, 0}),
      test::make_camera("kannala_brandt", 848, 800, {286, 287, 418, 402, -0.0056, 0.041, -0.038, 0.0062}),
      test::make_camera("kannala_brandt", 1920, 1208,
                        {1176.93, 1177.72, 962.275, 612.725, -0.0540096, -0.0784275, 0.0959641, -0.0515253}),
      test::make_camera("double_sphere", 512, 512, {157, 157.5, 254, 256, -0.18, 0.59}),
      test::make_camera("double_sphere", 848, 800, {300, 301, 420, 405, 0.3, 0.65}),
  };
}

/// Normalised estimation error squared per parameter: 1 on average where the covariance is right.
double nees(const IntrinsicsEstimate& estimate, const Camera& truth) {
  const Eigen::VectorXd error = estimate.camera.parameters - truth.parameters;
  return error.dot(estimate.covariance.ldlt().solve(error)) / static_cast<double>(error.size());
}

TEST(EstimateIntrinsics, FindsTheTruthWithinItsSigma) {
  std::mt19937_64 rng(1);
  for (const Camera& truth : true_cameras()) {
    for (const double sigma : {0.05, 0.2}) {
      const auto views = simulate_views(truth, 20, sigma, 0.1, rng);
      const auto estimate =
          estimate_intrinsics(checkerboard(), truth.width, truth.height, truth.model->name(), views.corners);
      ASSERT_TRUE(estimate) << test::describe(truth) << "\n" << estimate.error().text();
      EXPECT_NEAR(estimate->noise_scale, sigma / 0.1, 0.1 * sigma / 0.1) << test::describe(truth);
      EXPECT_NEAR(estimate->reprojection_rms, sigma * std::sqrt(2), 0.15 * sigma) << test::describe(truth);
      EXPECT_LT(estimate->projection_sigma, sigma) << test::describe(truth);
      for (Eigen::Index i = 0; i < truth.parameters.size(); ++i) {
        const double error = estimate->camera.parameters[i] - truth.parameters[i];
        // 88 numbers: one beyond 3 sigma is to be expected every fourth time, one beyond 4 never.
        EXPECT_LT(std::abs(error), 4 * std::sqrt(estimate->covariance(i, i)))
            << test::describe(truth) << " " << truth.model->parameter_names()[i];
      }
      for (std::size_t i = 0; i < views.poses.size(); ++i) {
        EXPECT_TRUE(estimate->views[i].used) << estimate->views[i].reason;
        ASSERT_TRUE(estimate->views[i].T_camera_board);
        const Pose difference = views.poses[i].inverse() * *estimate->views[i].T_camera_board;
        EXPECT_LT(difference.t.norm(), 0.02 * views.poses[i].t.norm());
      }
    }
  }
}

TEST(EstimateIntrinsics, ExactCornersGiveTheExactCamera) {
  std::mt19937_64 rng(2);
  for (const Camera& truth : true_cameras()) {
    const auto views = simulate_views(truth, 12, 0, 0.1, rng);
    const auto estimate =
        estimate_intrinsics(checkerboard(), truth.width, truth.height, truth.model->name(), views.corners);
    ASSERT_TRUE(estimate) << test::describe(truth) << "\n" << estimate.error().text();
    EXPECT_LT((estimate->camera.parameters - truth.parameters).norm(), 1e-4) << test::describe(truth);
  }
}

TEST(EstimateIntrinsics, CovarianceAgreesWithSampling) {
  for (const Camera& truth : {true_cameras()[0], true_cameras()[2], true_cameras()[4]}) {
    std::mt19937_64 rng(3);
    double sum = 0;
    const int runs = 30;
    for (int run = 0; run < runs; ++run) {
      const auto views = simulate_views(truth, 15, 0.1, 0.3, rng);
      const auto estimate =
          estimate_intrinsics(checkerboard(), truth.width, truth.height, truth.model->name(), views.corners);
      ASSERT_TRUE(estimate) << estimate.error().text();
      sum += nees(*estimate, truth);
    }
    // The mean of 30 chi-square over n has a standard deviation of about 0.09.
    EXPECT_NEAR(sum / runs, 1, 0.3) << test::describe(truth);
    RecordProperty("nees_" + std::string(truth.model->name()), std::to_string(sum / runs));
    std::printf("NEES %s %.3f\n", test::describe(truth).c_str(), sum / runs);
  }
}

}  // namespace
}  // namespace ca2
