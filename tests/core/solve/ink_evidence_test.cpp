/// Which way round a print lies, by what came back from its squares.
#include "core/solve/ink_evidence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "core/solve/half_turn.h"
#include "tests/core/solve/rim_scan.h"

namespace ca2 {
namespace {

Board checkerboard(int columns, int rows) {
  Board board;
  board.type = find_board_type("checkerboard");
  board.columns = columns;
  board.rows = rows;
  board.square = 0.06;
  board.outline = Outline{0.6, 0.45, {0, 0}};
  return board;
}

/// What comes back from a place on the board, before the lasers' gains.
using Intensity = std::function<double(const Eigen::Vector2d& p, std::mt19937_64& rng)>;

/// Rings 12 mm apart on the plate, with a return every 7 mm.
LidarSight seen(const Board& board, const Pose& T_lidar_board, const Intensity& intensity,
                std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> gain(0.5, 1);
  LidarSight sight;
  sight.plane = board_plane(T_lidar_board);
  sight.rms = 0.005;
  const Outline& plate = *board.outline;
  std::uint16_t ring = 0;
  for (double y = -0.5 * plate.height; y < 0.5 * plate.height; y += 0.012) {
    const double own = gain(rng);
    ++ring;
    for (double x = -0.5 * plate.width; x < 0.5 * plate.width; x += 0.007) {
      BoardReturn& here = sight.on_board.emplace_back();
      here.point = (T_lidar_board * Eigen::Vector3d(x, y, 0)).cast<float>();
      here.ring = ring;
      here.intensity =
          static_cast<std::uint16_t>(std::clamp(30000 * own * intensity({x, y}, rng), 0., 65000.));
    }
  }
  return sight;
}

struct Odds {
  double right, wrong;
};
Odds odds_of(const Board& board, const Intensity& intensity, std::uint64_t seed) {
  const InkMap ink(board);
  const Pose T = plate_at(0.1);
  const LidarSight sight = seen(board, T, intensity, seed);
  return {ink_log_odds(sight, ink, *board.outline, T),
          ink_log_odds(sight, ink, *board.outline, half_turned(T))};
}

/// The print with so much noise, black sending back `black` of what white does.
Intensity printed(const Board& board, double black, double noise) {
  return [&board, black, noise](const Eigen::Vector2d& p, std::mt19937_64& rng) {
    return (board.type->black(board, p) ? black : 1) + std::normal_distribution<double>(0, noise)(rng);
  };
}

TEST(InkEvidence, TellsWhichWayRoundAPrintLies) {
  const Board board = checkerboard(8, 5);
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Odds odds = odds_of(board, printed(board, 0.5, 0.2), seed);
    EXPECT_GT(odds.right, 100);
    EXPECT_EQ(odds.wrong, 0);  // black and white exchanged
  }
}

TEST(InkEvidence, APrintThatHalfATurnLeavesAloneTellsNothing) {
  const Board board = checkerboard(8, 6);
  const Odds odds = odds_of(board, printed(board, 0.3, 0.1), 1);
  EXPECT_GT(odds.right, 100);
  EXPECT_NEAR(odds.right, odds.wrong, 1e-6 * odds.right);
}

// What has nothing to do with the print - noise, spots of light, ink that the laser does not see - must not
// seem to be it at odds of a thousand.
TEST(InkEvidence, ChanceIsNotBelieved) {
  const Board board = checkerboard(8, 5);
  int believed = 0;
  constexpr std::uint64_t trials = 300;
  for (std::uint64_t seed = 1; seed <= trials; ++seed) {
    std::mt19937_64 rng(1000 + seed);
    std::uniform_real_distribution<double> unit(-1, 1);
    const Eigen::Vector2d spot(0.3 * unit(rng), 0.2 * unit(rng));
    const double size = 0.05 + 0.1 * std::abs(unit(rng)), slope = unit(rng);
    const Odds odds = odds_of(
        board,
        [&](const Eigen::Vector2d& p, std::mt19937_64& noise) {
          return 0.8 + slope * p.x() + std::exp(-0.5 * (p - spot).squaredNorm() / (size * size)) +
                 std::normal_distribution<double>(0, 0.1)(noise);
        },
        seed);
    believed += std::max(odds.right, odds.wrong) > std::log(1000.0) ? 1 : 0;
  }
  EXPECT_LE(believed, 2) << "of " << trials;
}

TEST(InkEvidence, WithoutIntensitiesThereIsNone) {
  const Board board = checkerboard(8, 5);
  const InkMap ink(board);
  LidarSight sight = seen(board, plate_at(0.1), printed(board, 0.5, 0.1), 1);
  for (BoardReturn& here : sight.on_board) here.intensity = BoardReturn::no_intensity;
  EXPECT_EQ(ink_log_odds(sight, ink, *board.outline, plate_at(0.1)), 0);
  for (BoardReturn& here : sight.on_board) here.intensity = 30000;
  EXPECT_EQ(ink_log_odds(sight, ink, *board.outline, plate_at(0.1)), 0);
}

}  // namespace
}  // namespace ca2
