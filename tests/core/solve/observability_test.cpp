/// The verdict and its words.
#include "core/solve/observability.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace ca2 {
namespace {

/// Boards turned and tipped by up to these angles [rad], and an answer known to a millimetre and milliradian.
PairEvidence evidence(int views, double turn, double tip) {
  PairEvidence e{"camera", "lidar", {}, 1e-6 * Matrix6d::Identity(), {}, 0.0005, views};
  for (int i = 0; i < views; ++i) {
    const double a = turn * ((i % 3) - 1);
    const double b = tip * (((i / 3) % 3) - 1);
    e.normals.push_back(Eigen::Vector3d(std::sin(a), std::sin(b), -1).normalized());
  }
  return e;
}

std::string refusal(const PairEvidence& e) {
  const auto verdict = judge(e);
  if (verdict) return "";
  EXPECT_EQ(verdict.error().code, ErrorCode::refused);
  return verdict.error().text();
}

TEST(Observability, GoodViewsAreGood) {
  const auto verdict = judge(evidence(9, 0.5, 0.5));
  ASSERT_TRUE(verdict);
  EXPECT_EQ(verdict->verdict, "good");
}

TEST(Observability, ThreeViewsCannotBeChecked) {
  PairEvidence e = evidence(9, 0.5, 0.5);
  e.normals = {e.normals[0], e.normals[2], e.normals[6]};
  e.candidates = 3;
  const auto verdict = judge(e);
  ASSERT_TRUE(verdict);
  EXPECT_EQ(verdict->verdict, "weak");
}

TEST(Observability, MostViewsRejectedIsNeverGood) {
  PairEvidence e = evidence(9, 0.5, 0.5);
  e.candidates = 16;
  const auto verdict = judge(e);
  ASSERT_TRUE(verdict);
  EXPECT_EQ(verdict->verdict, "weak");
}

TEST(Observability, WordsNameTheCure) {
  EXPECT_NE(refusal(evidence(2, 0.5, 0.5)).find("only 2 views"), std::string::npos);
  EXPECT_NE(refusal(evidence(1, 0.5, 0.5)).find("only 1 view could"), std::string::npos);
  EXPECT_NE(refusal(evidence(9, 0.004, 0.004)).find("nearly parallel"), std::string::npos);
  const std::string turned_only = refusal(evidence(9, 0.5, 0));
  EXPECT_NE(turned_only.find("one plane"), std::string::npos) << turned_only;
  EXPECT_NE(turned_only.find("tip the board"), std::string::npos) << turned_only;
  const std::string tipped_only = refusal(evidence(9, 0, 0.5));
  EXPECT_NE(tipped_only.find("turn the board"), std::string::npos) << tipped_only;
}

TEST(Observability, UncertainAnswersAreRefused) {
  PairEvidence e = evidence(9, 0.5, 0.5);
  e.covariance *= 1e4;
  EXPECT_NE(refusal(e).find("173 mm"), std::string::npos) << refusal(e);
  e.covariance.setIdentity();
  e.covariance.diagonal().setConstant(std::numeric_limits<double>::infinity());
  EXPECT_FALSE(refusal(e).empty());
}

TEST(Observability, TheWeakestDirectionIsInTheCamerasAxes) {
  PairEvidence e = evidence(9, 0.5, 0.5);
  e.T_camera_lidar.R << 0, -1, 0, 0, 0, -1, 1, 0, 0;  // LiDAR x is the camera's z
  e.covariance(3, 3) = 1e-5;
  EXPECT_NE(judge(e)->weakest_direction.find("depth"), std::string::npos);
}

}  // namespace
}  // namespace ca2
