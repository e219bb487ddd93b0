// Intrinsics from simulated corners, against truth, against sampling and against OpenCV.
#include "core/intrinsics/estimate_intrinsics.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <opencv2/calib3d.hpp>

#include "tests/core/intrinsics/simulated_views.h"

namespace ca2 {
namespace {

using test::checkerboard;
using test::simulate_views;

// Double sphere lenses with xi < 0, as real ones have: within 82 degrees a lens with xi > 0 has a second fit
// that 0.1 px of noise does not tell from the first.
std::vector<Camera> true_cameras() {
  return {
      test::make_camera("pinhole_radtan", 1388, 1038,
                        {1100, 1103, 700, 512, -0.21, 0.11, 0.001, -0.0007, -0.02}),
      test::make_camera("pinhole_radtan", 640, 480, {900, 905, 315, 250, -0.3, 0.2, 0.001, 0.002, 0}),
      test::make_camera("kannala_brandt", 848, 800, {286, 287, 418, 402, -0.0056, 0.041, -0.038, 0.0062}),
      test::make_camera("kannala_brandt", 1920, 1208,
                        {1176.93, 1177.72, 962.275, 612.725, -0.0540096, -0.0784275, 0.0959641, -0.0515253}),
      test::make_camera("double_sphere", 512, 512, {157, 157.5, 254, 256, -0.18, 0.59}),
      test::make_camera("double_sphere", 848, 800, {230, 231, 420, 405, -0.25, 0.55}),
  };
}

/// Normalised estimation error squared per parameter: 1 on average where the covariance is right.
double nees(const IntrinsicsEstimate& estimate, const Camera& truth) {
  const Eigen::VectorXd error = estimate.camera.parameters - truth.parameters;
  return error.dot(estimate.covariance.ldlt().solve(error)) / static_cast<double>(error.size());
}

/// What projection_sigma predicts: the rms difference of the two cameras' pixels for the rays of the boards,
/// after the rotation between them that makes it smallest.
double projection_error(const IntrinsicsEstimate& estimate, const Camera& truth,
                        const test::SimulatedViews& views) {
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
  double squares = 0, count = 0;
  for (const std::vector<Corner>& corners : views.corners) {
    for (const Corner& corner : corners) {
      const auto ray = truth.unproject(corner.pixel);
      ProjectionJacobian jacobian;
      const auto pixel = estimate.camera.project(*ray, &jacobian);
      const Eigen::Vector2d difference = *pixel - corner.pixel;
      const Eigen::Matrix<double, 2, 3> J = -jacobian.point * skew(*ray);
      H += J.transpose() * J;
      g += J.transpose() * difference;
      squares += difference.squaredNorm();
      ++count;
    }
  }
  return std::sqrt((squares - g.dot(H.ldlt().solve(g))) / count);
}

TEST(EstimateIntrinsics, FindsTheTruthWithinItsSigma) {
  std::mt19937_64 rng(1);
  for (const Camera& truth : true_cameras()) {
    for (const double sigma : {0.05, 0.2}) {
      const auto views = simulate_views(truth, 30, sigma, 0.1, rng);
      const auto estimate =
          estimate_intrinsics(checkerboard(), truth.width, truth.height, truth.model->name(), views.corners);
      ASSERT_TRUE(estimate) << test::describe(truth) << "\n" << estimate.error().text();
      EXPECT_NEAR(estimate->noise_scale, sigma / 0.1, 0.1 * sigma / 0.1) << test::describe(truth);
      EXPECT_NEAR(estimate->reprojection_rms, sigma * std::sqrt(2), 0.15 * sigma) << test::describe(truth);
      EXPECT_LT(estimate->projection_sigma, 5 * sigma) << test::describe(truth);
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
    const auto views = simulate_views(truth, 12, 0, 0.1, rng, 0.7, false, M_PI);
    const auto estimate =
        estimate_intrinsics(checkerboard(), truth.width, truth.height, truth.model->name(), views.corners);
    ASSERT_TRUE(estimate) << test::describe(truth) << "\n" << estimate.error().text();
    EXPECT_LT((estimate->camera.parameters - truth.parameters).norm(), 1e-4) << test::describe(truth);
  }
}

TEST(EstimateIntrinsics, CovarianceAgreesWithSampling) {
  for (const Camera& truth : {true_cameras()[0], true_cameras()[2], true_cameras()[4]}) {
    std::mt19937_64 rng(3);
    double sum = 0, squares = 0, predicted = 0;
    const int runs = 30;
    for (int run = 0; run < runs; ++run) {
      const auto views = simulate_views(truth, 20, 0.1, 0.3, rng);
      const auto estimate =
          estimate_intrinsics(checkerboard(), truth.width, truth.height, truth.model->name(), views.corners);
      ASSERT_TRUE(estimate) << estimate.error().text();
      sum += nees(*estimate, truth);
      squares += std::pow(projection_error(*estimate, truth, views), 2);
      predicted += std::pow(estimate->projection_sigma, 2);
    }
    // The mean of 30 chi-square over n has a standard deviation of about 0.09.
    EXPECT_NEAR(sum / runs, 1, 0.3) << test::describe(truth);
    EXPECT_NEAR(std::sqrt(squares / predicted), 1, 0.3) << test::describe(truth);
  }
}

TEST(EstimateIntrinsics, AgreesWithOpenCv) {
  std::mt19937_64 rng(4);
  const Camera truth = true_cameras()[0];
  const auto views = simulate_views(truth, 20, 0.1, 0.1, rng);
  const auto estimate =
      estimate_intrinsics(checkerboard(), truth.width, truth.height, "pinhole_radtan", views.corners);
  ASSERT_TRUE(estimate) << estimate.error().text();
  std::vector<std::vector<cv::Point3f>> points;
  std::vector<std::vector<cv::Point2f>> pixels;
  const auto board = checkerboard().type->corners(checkerboard());
  for (const auto& corners : views.corners) {
    points.emplace_back();
    pixels.emplace_back();
    for (const Corner& corner : corners) {
      const Eigen::Vector2d& p = board[static_cast<std::size_t>(corner.id)];
      points.back().emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()), 0.f);
      pixels.back().emplace_back(static_cast<float>(corner.pixel.x()), static_cast<float>(corner.pixel.y()));
    }
  }
  cv::Mat K, D, sigma, unused;
  std::vector<cv::Mat> rotations, translations;
  const double rms =
      cv::calibrateCamera(points, pixels, {truth.width, truth.height}, K, D, rotations, translations, sigma,
                          unused, unused, 0, {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 200, 1e-14});
  EXPECT_NEAR(estimate->reprojection_rms, rms, 1e-3 * rms);
  const std::vector<double> theirs{K.at<double>(0, 0), K.at<double>(1, 1), K.at<double>(0, 2),
                                   K.at<double>(1, 2), D.at<double>(0),    D.at<double>(1),
                                   D.at<double>(2),    D.at<double>(3),    D.at<double>(4)};
  // OpenCV divides the sum of 2 N squared errors by N less the unknowns, not by 2 N less the unknowns.
  const double n = 48 * 20, unknowns = 9 + 6 * 20;
  const double excess = std::sqrt((2 * n - unknowns) / (n - unknowns));
  for (Eigen::Index i = 0; i < 9; ++i) {
    const double ours = std::sqrt(estimate->covariance(i, i));
    // OpenCV reads the pixels as floats, and Huber's weights are not its: a tenth of sigma is close.
    EXPECT_NEAR(estimate->camera.parameters[i], theirs[static_cast<std::size_t>(i)], 0.1 * ours) << i;
    EXPECT_NEAR(ours * excess, sigma.at<double>(static_cast<int>(i)), 0.05 * ours) << i;
  }
}

TEST(EstimateIntrinsics, WrongViewsAndCornersAreSetAsideWithAReason) {
  std::mt19937_64 rng(5);
  for (const Camera& truth : {true_cameras()[0], true_cameras()[2]}) {
    auto views = simulate_views(truth, 20, 0.1, 0.1, rng);
    const auto clean =
        estimate_intrinsics(checkerboard(), truth.width, truth.height, truth.model->name(), views.corners);
    ASSERT_TRUE(clean) << clean.error().text();
    std::normal_distribution<double> normal;
    for (const std::size_t bad : {std::size_t{3}, std::size_t{11}}) {  // smeared, as by motion
      for (Corner& corner : views.corners[bad]) corner.pixel.x() += 4 * normal(rng);
    }
    views.corners[7][20].pixel.x() += 12;  // one corner on the wrong square's edge
    views.corners[8].resize(3);
    const auto estimate =
        estimate_intrinsics(checkerboard(), truth.width, truth.height, truth.model->name(), views.corners);
    ASSERT_TRUE(estimate) << estimate.error().text();
    for (std::size_t i = 0; i < views.corners.size(); ++i) {
      const bool bad = i == 3 || i == 11 || i == 8;
      EXPECT_EQ(estimate->views[i].used, !bad) << i << " " << estimate->views[i].reason;
      EXPECT_EQ(estimate->views[i].reason.empty(), !bad);
    }
    EXPECT_EQ(estimate->views[7].corners_rejected, 1);
    EXPECT_LT(nees(*estimate, truth), 3);
    EXPECT_NEAR(estimate->reprojection_rms, clean->reprojection_rms, 0.1 * clean->reprojection_rms);
  }
}

void expect_refused(const Result<IntrinsicsEstimate>& result, const std::string& words) {
  ASSERT_FALSE(result) << words;
  EXPECT_EQ(result.error().code, ErrorCode::refused);
  EXPECT_NE(result.error().text().find(words), std::string::npos) << result.error().text();
}

TEST(EstimateIntrinsics, ViewsThatCannotTellAreRefusedInWords) {
  std::mt19937_64 rng(6);
  const Camera truth = true_cameras()[0];
  const auto estimate = [&](const std::vector<std::vector<Corner>>& corners) {
    return estimate_intrinsics(checkerboard(), truth.width, truth.height, "pinhole_radtan", corners);
  };
  expect_refused(estimate({}), "0 of 0 views");
  expect_refused(estimate(simulate_views(truth, 4, 0.1, 0.1, rng).corners),
                 "4 of 4 views can be used, 5 are needed");
  expect_refused(estimate(simulate_views(truth, 20, 0.1, 0.1, rng, 0, true).corners),
                 "all boards face the same way");

  // A window's width of tilt about both axes, with coarse corners: an answer, but a poor one.
  expect_refused(estimate(simulate_views(truth, 6, 2.0, 1.0, rng, 0.1).corners), "only known to");

  auto one_place = simulate_views(truth, 60, 0.1, 0.1, rng);
  std::erase_if(one_place.corners, [&](const std::vector<Corner>& corners) {
    return std::any_of(corners.begin(), corners.end(),
                       [&](const Corner& c) { return c.pixel.x() > 0.5 * truth.width; });
  });
  ASSERT_GE(one_place.corners.size(), 5u);
  for (auto& corners : one_place.corners) corners = one_place.corners.front();
  expect_refused(estimate(one_place.corners), "show the board at the picture's right");

  auto noise = simulate_views(truth, 8, 0.1, 0.1, rng);
  for (auto& corners : noise.corners) {
    for (Corner& corner : corners) corner.pixel = test::random_pixel(truth, rng);
  }
  EXPECT_FALSE(estimate(noise.corners));

  for (auto& corners : noise.corners) {
    for (Corner& corner : corners) corner.pixel.x() = std::nan("");
  }
  expect_refused(estimate(noise.corners), "fewer than 6 corners");

  const auto unknown = estimate_intrinsics(checkerboard(), 640, 480, "pinhole", noise.corners);
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, ErrorCode::usage);
}

TEST(EstimateIntrinsics, TheSameViewsGiveTheSameBits) {
  std::mt19937_64 rng(7);
  const Camera truth = true_cameras()[4];
  const auto views = simulate_views(truth, 10, 0.1, 0.1, rng);
  const auto a =
      estimate_intrinsics(checkerboard(), truth.width, truth.height, "double_sphere", views.corners);
  const auto b =
      estimate_intrinsics(checkerboard(), truth.width, truth.height, "double_sphere", views.corners);
  ASSERT_TRUE(a && b);
  EXPECT_EQ((a->camera.parameters - b->camera.parameters).norm(), 0);
  EXPECT_EQ((a->covariance - b->covariance).norm(), 0);
}

}  // namespace
}  // namespace ca2
