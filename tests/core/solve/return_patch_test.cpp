/// Returns summed once and for all, but for the few near the rim and the gate, are as good as all of them
/// summed again.
#include "core/solve/return_patch.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

namespace ca2 {
namespace {

const Outline outline{0.8, 0.6, {0.01, -0.02}};
const double margin = 0.01;

Pose board_pose() {
  Vector6d turn;
  turn << 0.3, -0.2, 0.5, 0, 0, 0;
  return Pose{(Eigen::Matrix3d() << 0, 0, 1, -1, 0, 0, 0, -1, 0).finished(), {3, 0.4, -0.2}}.perturbed(turn);
}

const Board& board() {
  static const Board made = [] {
    Board b;
    b.type = find_board_type("checkerboard");
    b.columns = 6;
    b.rows = 4;
    b.square = 0.1;
    b.outline = outline;
    return b;
  }();
  return made;
}

/// Where the ray of a return meets the board at `pose`, board frame, m.
Eigen::Vector3d meets(const BoardReturn& here, const Pose& pose) {
  const Eigen::Vector3d origin(0, 0, here.height), way = here.point.cast<double>() - origin;
  const Plane plane = board_plane(pose);
  return pose.inverse() * (origin - plane.distance(origin) / plane.normal.dot(way) * way);
}

/// A board at `pose` with noise, dark print that is measured too far, rings that are off and begin at
/// different heights, and things beside and behind it.
LidarSight sight_of(const Pose& pose, double sigma) {
  std::mt19937_64 rng(4);
  std::normal_distribution<double> noise(0, sigma);
  std::uniform_real_distribution<double> x(-0.6, 0.6), y(-0.45, 0.45), gap(0.05, 1);
  LidarSight sight;
  for (int i = 0; i < 4000; ++i) {
    const Eigen::Vector3d place(x(rng), y(rng), i % 10 == 0 ? gap(rng) : 0);
    const Eigen::Vector3d p = pose * place;
    const auto ring = static_cast<std::uint16_t>(std::lround((p.z() / p.norm() + 1) * 60));
    const auto height = static_cast<float>(0.001 * ring - 0.03);
    const Eigen::Vector3d origin(0, 0, height), way = p - origin;
    const bool dark = board().type->black(board(), place.head<2>());
    const double off = noise(rng) + 0.002 * (ring % 3) + (dark ? 0.004 : 0);
    auto& list = i % 3 ? sight.on_board : sight.around;
    list.push_back(
        {(origin + (1 + off / way.norm()) * way).cast<float>(), ring, BoardReturn::no_intensity, height});
  }
  sight.plane = board_plane(pose);
  return sight;
}

/// What the sums stand for, of all returns, one by one, classified where the board was when they were last
/// all looked at.
RangeSums one_by_one(const LidarSight& sight, const Pose& first, const Pose& pose,
                     const Eigen::Vector3d& reference, double bias, double gate, const InkMap& ink,
                     const RangeCorrection& correction) {
  std::vector<BoardReturn> chosen;
  for (const auto* list : {&sight.on_board, &sight.around}) {
    for (const BoardReturn& here : *list) {
      const Eigen::Vector3d place = meets(here, pose);
      if (std::abs(place.x() - outline.center.x()) > outline.width / 2 - margin ||
          std::abs(place.y() - outline.center.y()) > outline.height / 2 - margin) {
        continue;
      }
      const Eigen::Vector3d origin(0, 0, here.height), way = here.point.cast<double>() - origin;
      const Eigen::Vector3d was = meets(here, first);
      const double spot = 0.004 * (first * was - origin).norm();
      const double off = correction.at(here.ring, RangeClasses::bin(ink.share(was.head<2>(), spot)));
      if (std::abs(way.norm() - off - (pose * place - origin).norm() - bias) > gate) continue;
      chosen.push_back(here);
      chosen.back().point = (origin + (1 - off / way.norm()) * way).cast<float>();
    }
  }
  return range_sums(chosen, reference, 0, 1e9);
}

class Moves : public testing::TestWithParam<double> {};

TEST_P(Moves, SumsAreThoseOfAllReturns) {
  const double gate = 0.05, bias = 0.004;
  const Pose base = board_pose();
  const LidarSight sight = sight_of(base, 0.008);
  const InkMap ink(board());
  ReturnPatch patch(sight, ink);
  EXPECT_TRUE(patch.aim(outline, base, margin, bias, gate));
  ASSERT_TRUE(patch.highest_ring());
  const RangeClasses classes{*patch.highest_ring() + 1};
  EXPECT_GT(classes.rings, 10);
  RangeCorrection correction;
  correction.by_bin = {-0.001, 0, 0.001, 0.001, 0.002, 0.003};
  correction.by_ring.assign(static_cast<std::size_t>(classes.rings), 0);
  for (std::size_t i = 0; i < correction.by_ring.size(); ++i)
    correction.by_ring[i] = 0.002 * static_cast<double>(i % 3);
  std::mt19937_64 rng(5);
  std::normal_distribution<double> step(0, GetParam());
  Pose pose = base, classified = base;
  for (int move = 0; move < 20; ++move) {
    Vector6d d;
    for (int k = 0; k < 6; ++k) d(k) = step(rng);
    pose = pose.perturbed(d);
    if (patch.aim(outline, pose, margin, bias, gate)) classified = pose;
    patch.correct(correction);
    const RangeSums sums = patch.sums(board_plane(pose), bias, gate);
    const RangeSums all = one_by_one(sight, classified, pose, sums.reference, bias, gate, ink, correction);
    ASSERT_EQ(sums.weight, all.weight) << move;
    EXPECT_GT(sums.weight, 1000);
    // The points are rounded to floats, and again after their correction.
    EXPECT_NEAR(sums.cost, all.cost, 1e-5 * all.cost);
    EXPECT_LT((sums.gradient - all.gradient).norm(), 2e-5 * all.gradient.norm());
    EXPECT_LT((sums.H - all.H).norm(), 1e-5 * all.H.norm());
    // The reference stays close to the plane.
    EXPECT_LT((sums.reference - inverse_plane(board_plane(pose))).norm(), 1e-3);
  }
}

INSTANTIATE_TEST_SUITE_P(OfABoard, Moves, testing::Values(1e-6, 1e-5, 1e-4, 1e-3, 1e-2));

TEST(ReturnPatch, FitFindsThePlaneFromAfar) {
  const Pose pose = board_pose();
  LidarSight sight = sight_of(pose, 0);
  std::erase_if(sight.on_board, [&](const BoardReturn& here) {
    return board().type->black(board(), meets(here, pose).head<2>()) || here.ring % 3;
  });
  std::erase_if(sight.on_board, [&](const BoardReturn& here) {
    return std::abs(board_plane(pose).distance(here.point.cast<double>())) > 1e-3;
  });
  ASSERT_GT(sight.on_board.size(), 200u);
  const InkMap ink(board());
  ReturnPatch patch(sight, ink);
  Vector6d off;
  off << 0.1, -0.1, 0.05, 0, 0, 0.1;
  const Plane fit = patch.fit_found(board_plane(pose.perturbed(off)), 10);
  EXPECT_LT((fit.normal - board_plane(pose).normal).norm(), 1e-6);
  EXPECT_NEAR(fit.offset, board_plane(pose).offset, 1e-6);
}

}  // namespace
}  // namespace ca2
