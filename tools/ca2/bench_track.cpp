/// `ca2 bench track`: a frame of a moving board tracked from the frame before, against searching all of it.
#include <algorithm>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>

#include "core/board/track_board.h"
#include "core/geometry/so3.h"
#include "tools/ca2/bench.h"
#include "tools/ca2/bench_pictures.h"
#include "tools/ca2/bench_timing.h"

namespace ca2 {
namespace {

constexpr int sequences = 6;
constexpr int frames = 6;

struct Tally {
  std::vector<double> track_ms, find_ms;
  int pictures = 0, tracked = 0, found = 0;
  double worst_apart = 0;  ///< px between a tracked corner and the search's
};

/// Of the corners that both have. Half-turned ids of an ambiguous board are the same board.
double apart(const Board& board, const std::vector<Corner>& tracked, const std::vector<Corner>& found) {
  std::map<int, Eigen::Vector2d> pixel;
  for (const Corner& corner : found) pixel[corner.id] = corner.pixel;
  const int last = static_cast<int>(board.type->corners(board).size()) - 1;
  double straight = 0, turned = 0;
  for (const Corner& corner : tracked) {
    const auto same = pixel.find(corner.id), other = pixel.find(last - corner.id);
    if (same != pixel.end()) straight = std::max(straight, (corner.pixel - same->second).norm());
    if (other != pixel.end()) turned = std::max(turned, (corner.pixel - other->second).norm());
  }
  return board.type->half_turn_ambiguous(board) ? std::min(straight, turned) : straight;
}

/// A person who carries the board: up to 6 mm and 1 degree from one frame to the next.
void follow(const BenchCamera& bench, const Board& board, int repeats, std::mt19937_64& random,
            Tally& tally) {
  std::uniform_real_distribution<double> step(-1, 1);
  Pose T = random_board_pose(board, bench.camera, bench.places, random);
  std::vector<Corner> corners = board.type->find(board, board_picture(board, bench.camera, T, random));
  for (int frame = 0; frame < frames; ++frame) {
    T.t += 0.006 * Eigen::Vector3d(step(random), step(random), step(random));
    T.R = T.R * so3_exp(0.017 * Eigen::Vector3d(step(random), step(random), step(random)));
    const Image image = board_picture(board, bench.camera, T, random);
    std::vector<Corner> tracked, found;
    std::vector<double> track_ms, find_ms;
    for (int i = 0; i < repeats; ++i) {
      double start = cpu_ms();
      tracked = track_board(board, image, corners);
      track_ms.push_back(cpu_ms() - start);
      start = cpu_ms();
      found = board.type->find(board, image);
      find_ms.push_back(cpu_ms() - start);
    }
    tally.track_ms.push_back(median(track_ms));
    tally.find_ms.push_back(median(find_ms));
    ++tally.pictures;
    tally.tracked += tracked.empty() ? 0 : 1;
    tally.found += found.empty() ? 0 : 1;
    if (!tracked.empty() && !found.empty()) {
      tally.worst_apart = std::max(tally.worst_apart, apart(board, tracked, found));
    }
    corners = tracked.empty() ? found : tracked;
  }
}

}  // namespace

Result<int> bench_track(const BenchOptions& options) {
  std::vector<std::pair<Board, BenchCamera>> pairs;
  for (const Board& board : bench_boards()) {
    if (board.type->name().find(options.only) == std::string_view::npos) continue;
    for (const BenchCamera& bench : bench_cameras()) pairs.emplace_back(board, bench);
  }
  std::mt19937_64 random(2025);
  nlohmann::json rows = nlohmann::json::array();
  if (!options.json) {
    std::printf(
        "CPU ms per picture of a moving board, median / worst, one thread.\n\n"
        "%-12s %-12s %8s | %15s | %15s | %6s | %7s %5s | %9s\n",
        "board", "camera", "pictures", "track", "find", "ratio", "tracked", "found", "apart, px");
  }
  for (const auto& [board, bench] : pairs) {
    const std::string type(board.type->name());
    Tally tally;
    for (int i = 0; i < sequences; ++i) follow(bench, board, options.repeats, random, tally);
    const double track = median(tally.track_ms), find = median(tally.find_ms);
    const double track_worst = *std::max_element(tally.track_ms.begin(), tally.track_ms.end());
    const double find_worst = *std::max_element(tally.find_ms.begin(), tally.find_ms.end());
    if (!options.json) {
      std::printf("%-12s %-12s %8d | %6.2f / %6.2f | %6.2f / %6.2f | %6.3f | %7d %5d | %9.3f\n", type.c_str(),
                  bench.name, tally.pictures, track, track_worst, find, find_worst, track / find,
                  tally.tracked, tally.found, tally.worst_apart);
      std::fflush(stdout);
    }
    rows.push_back({{"board", type},
                    {"camera", bench.name},
                    {"pictures", tally.pictures},
                    {"track_ms", {track, track_worst}},
                    {"find_ms", {find, find_worst}},
                    {"track_over_find", track / find},
                    {"tracked", tally.tracked},
                    {"found", tally.found},
                    {"worst_apart_px", tally.worst_apart}});
  }
  if (options.json) std::printf("%s\n", rows.dump(2).c_str());
  return 0;
}

}  // namespace ca2
