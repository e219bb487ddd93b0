/// The equations of a camera's corners are those of their errors, one by one.
#include "core/solve/corner_field.h"

#include <gtest/gtest.h>

#include <random>

namespace ca2 {
namespace {

const Pose T_camera_board{so3_exp({0.2, -0.3, 0.1}), {0.05, -0.02, 1.2}};

Camera camera() {
  Camera made{find_camera_model("pinhole_radtan"), CameraParameters(8), 1280, 960};
  made.parameters << 900, 910, 640, 480, -0.1, 0.05, 1e-3, -1e-3;
  return made;
}

/// `count` corners with noise; the last is far off.
CornerField field(int count, const CornerUnknowns& unknowns) {
  std::vector<Eigen::Vector2d> positions;
  std::vector<Corner> corners;
  std::mt19937_64 rng(1);
  std::normal_distribution<double> noise(0, 0.1);
  Eigen::Matrix2d covariance;
  covariance << 0.01, 0.004, 0.004, 0.02;
  for (int id = 0; id < count; ++id) {
    positions.emplace_back(0.04 * (id % 5) - 0.1, 0.04 * (id / 5) - 0.1);
    const Eigen::Vector3d place(positions.back().x(), positions.back().y(), 0);
    Corner corner;
    corner.id = id;
    corner.pixel = *camera().project(T_camera_board * place) + Eigen::Vector2d(noise(rng), noise(rng));
    if (id == count - 1) corner.pixel.x() += 5;
    corner.covariance = covariance;
    corners.push_back(corner);
  }
  return CornerField(corners, positions, unknowns);
}

CornerModel moved(const Camera& at, const Pose& pose) {
  return {at, pose, Eigen::Vector2d::Zero()};
}

class Counts : public testing::TestWithParam<int> {};

TEST_P(Counts, EquationsAreTheErrors) {
  const double scale = 1.5, huber = 3, reach = 1e-3;
  CornerField corners = field(GetParam(), {4, true});
  const Camera here = camera();
  ASSERT_TRUE(corners.approach(moved(here, T_camera_board), scale, huber, reach));
  const Eigen::Matrix2Xd errors = corners.errors(moved(here, T_camera_board));
  // The errors are linear within reach: their derivatives by differences are exact.
  const double step = 1e-5;
  Eigen::MatrixXd J(errors.size(), 12);
  for (int k = 0; k < 12; ++k) {
    Camera other = here;
    Vector6d d = Vector6d::Zero();
    Eigen::Vector2d stretch = Eigen::Vector2d::Zero();
    (k < 6 ? d(k) : k < 10 ? other.parameters(k - 6) : stretch(k - 10)) += step;
    const Pose pose = T_camera_board.perturbed(d);
    J.col(k) = (corners.errors({other, pose, stretch}) - errors).reshaped() / step;
  }
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(12, 12);
  Eigen::VectorXd g = Eigen::VectorXd::Zero(12);
  double cost = 0;
  int linear = 0;
  for (Eigen::Index i = 0; i < errors.cols(); ++i) {
    const double norm = errors.col(i).norm(), most = huber * scale;
    const double weight = norm <= most ? 1 : most / norm;
    linear += norm > most ? 1 : 0;
    cost += norm <= most ? 0.5 * norm * norm : most * (norm - 0.5 * most);
    H += weight * J.middleRows<2>(2 * i).transpose() * J.middleRows<2>(2 * i);
    g += weight * J.middleRows<2>(2 * i).transpose() * errors.col(i);
  }
  EXPECT_EQ(linear, 1);
  const CameraEquations sum = corners.equations(moved(here, T_camera_board), scale, huber);
  const double information = 1 / (scale * scale);
  EXPECT_LT((sum.H - information * H).norm(), 1e-6 * sum.H.norm());
  EXPECT_LT((sum.g - information * g).norm(), 1e-6 * sum.g.norm());
  EXPECT_NEAR(sum.cost, information * cost, 1e-9 * cost);
  EXPECT_NEAR(corners.cost(moved(here, T_camera_board), scale, huber), sum.cost, 1e-9 * cost);
}

// Whole fours of numbers and not.
INSTANTIATE_TEST_SUITE_P(OfCorners, Counts, testing::Values(24, 25));

}  // namespace
}  // namespace ca2
