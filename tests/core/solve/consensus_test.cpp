/// The closed form, and which of several hypotheses is the board, on synthetic planes.
#include "core/solve/consensus.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include "core/solve/plane_pairs.h"

namespace ca2 {
namespace {

struct World {
  std::mt19937_64 rng;
  Pose T_camera_lidar;
  explicit World(std::uint64_t seed) : rng(seed) {
    T_camera_lidar = Pose::from_quaternion(Eigen::Quaterniond(draw(), draw(), draw(), draw()),
                                           0.3 * Eigen::Vector3d(draw(), draw(), draw()));
  }
  double draw() { return std::normal_distribution<double>()(rng); }
  /// A board somewhere in front of the camera, tilted.
  Pose board() {
    const Eigen::Vector3d axis(0.5 * draw(), 0.5 * draw(), 0.3 * draw());
    return {so3_exp(axis), {0.5 * draw(), 0.3 * draw(), 2.5 + 0.3 * draw()}};
  }
  PatchPlane patch(const Pose& T_camera_board, double noise) {
    const Pose T_lidar_board = T_camera_lidar.inverse() * T_camera_board;
    PatchPlane patch{board_plane(T_lidar_board), T_lidar_board.t, 0.005};
    patch.plane.offset += noise * draw();
    return patch;
  }
};

TEST(PlanePairs, BothMethodsAreExactWithoutNoise) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    World world(seed);
    std::vector<PlanePair> pairs;
    while (pairs.size() < 6) {
      const Pose T_camera_board = world.board();
      const PlanePair pair{board_plane(T_camera_board), world.patch(T_camera_board, 0).plane};
      // Both methods take it that both sensors look at the same side.
      if (pair.camera.normal.dot(world.T_camera_lidar.R * pair.lidar.normal) > 0) pairs.push_back(pair);
    }
    const auto closed = solve_closed_form(pairs);
    const auto iterated = solve_plane_to_plane(pairs);
    ASSERT_TRUE(closed && iterated);
    EXPECT_LT(world.T_camera_lidar.difference(*closed).norm(), 1e-9);
    EXPECT_LT(world.T_camera_lidar.difference(iterated->T_camera_lidar).norm(), 1e-9);
  }
}

TEST(PlanePairs, TwoOrCoplanarNormalsHaveNoAnswer) {
  World world(3);
  std::vector<PlanePair> pairs;
  for (int i = 0; i < 5; ++i) {
    const Pose T_camera_board{so3_exp({0, 0.2 * (i - 2), 0}), {0.1 * i, 0, 2}};
    pairs.push_back({board_plane(T_camera_board), world.patch(T_camera_board, 0).plane});
  }
  EXPECT_FALSE(solve_closed_form(pairs));
  EXPECT_FALSE(solve_closed_form(std::span(pairs).first(2)));
  EXPECT_FALSE(solve_plane_to_plane(pairs));
}

TEST(Consensus, FindsTheBoardAmongOtherPlanes) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    World world(seed);
    std::vector<ConsensusView> views;
    std::vector<int> truth;
    for (int v = 0; v < 10; ++v) {
      const Pose T_camera_board = world.board();
      ConsensusView& view = views.emplace_back();
      view.camera = board_plane(T_camera_board);
      view.center = T_camera_board.t;
      const bool seen = v % 3 != 0;  // four of ten views hold only wrong objects
      for (int k = 0; k < 2; ++k) view.patches.push_back(world.patch(world.board(), 0.003));
      truth.push_back(seen ? v % 2 : -1);
      if (seen) view.patches[static_cast<std::size_t>(v % 2)] = world.patch(T_camera_board, 0.003);
    }
    const auto consensus = find_consensus(views, {});
    ASSERT_TRUE(consensus) << seed;
    const Vector6d error = world.T_camera_lidar.difference(consensus->T_camera_lidar);
    EXPECT_LT(error.head<3>().norm(), 0.03) << seed;
    EXPECT_LT(error.tail<3>().norm(), 0.05) << seed;
    for (std::size_t v = 0; v < views.size(); ++v) {
      if (truth[v] < 0) continue;
      EXPECT_EQ(consensus->patch[v], truth[v]) << seed << " view " << v;
    }
  }
}

TEST(Consensus, NothingAgrees) {
  World world(9);
  std::vector<ConsensusView> views(2);
  EXPECT_FALSE(find_consensus(views, {}));
  views.resize(6);
  EXPECT_FALSE(find_consensus(views, {}));  // no hypotheses at all
}

}  // namespace
}  // namespace ca2
