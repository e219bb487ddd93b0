/// `ca2 bench lidar`: the board searched for in one revolution of an OS0-128, there and not there.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "core/lidar/board_candidate.h"
#include "tools/ca2/bench.h"
#include "tools/ca2/bench_lidar_scenes.h"
#include "tools/ca2/bench_timing.h"

namespace ca2 {
namespace {

constexpr int scene_count = 12;

/// The least a search can do: the range of every return, once.
double floor_once(const Scan& scan) {
  const double start = cpu_ms();
  float sum = 0;
  for (const Eigen::Vector3f& point : scan.points) sum += std::sqrt(point.squaredNorm());
  keep(&sum);
  return cpu_ms() - start;
}

/// One kind of scans: a median per scan, over which the table's median and worst are.
struct Tally {
  std::string name;
  std::vector<double> ms, ratios;
  double returns = 0, candidates = 0;
  int found = 0, first = 0;
};

bool is_board(const BoardCandidate& candidate, const Eigen::Vector3d& p_board) {
  return (candidate.T_lidar_board.t - p_board).norm() < 0.1;
}

void search(const Scan& scan, const Eigen::Vector3d* p_board, int repeats, BoardFinder& finder,
            Tally& tally) {
  std::vector<double> ms, ratios;
  std::vector<BoardCandidate> found;
  for (int i = 0; i <= repeats; ++i) {
    const double start = cpu_ms();
    found = finder.find(scan);
    const double once = cpu_ms() - start, least = floor_once(scan);
    if (i == 0) continue;  // finds the memory
    ms.push_back(once);
    ratios.push_back(once / least);
  }
  tally.ms.push_back(median(ms));
  tally.ratios.push_back(median(ratios));
  tally.returns += static_cast<double>(scan.size()) / scene_count;
  tally.candidates += static_cast<double>(found.size()) / scene_count;
  if (!p_board) return;
  const auto at = std::find_if(found.begin(), found.end(), [&](const BoardCandidate& candidate) {
    return is_board(candidate, *p_board);
  });
  tally.found += at != found.end();
  tally.first += at != found.end() && at == found.begin();
}

}  // namespace

Result<int> bench_lidar(const BenchOptions& options) {
  const Result<std::vector<LidarBenchScene>> scenes = lidar_bench_scenes(scene_count);
  if (!scenes) return fail(scenes.error());
  BoardFinder finder(lidar_bench_board());
  Tally present{"board present", {}, {}}, absent{"board absent", {}, {}};
  for (const LidarBenchScene& scene : *scenes) {
    search(scene.present, &scene.p_board, options.repeats, finder, present);
    search(scene.absent, nullptr, options.repeats, finder, absent);
  }
  if (!options.json) {
    std::printf(
        "CPU ms per revolution of an OS0-128 (128 x 1024), median / worst of %d scans, each the median of "
        "%d;\n"
        "one thread. The floor takes the range of every return once.\n\n"
        "%-14s %9s | %15s | %15s | %10s\n",
        scene_count, options.repeats, "scans", "returns", "search", "x floor", "candidates");
  }
  nlohmann::ordered_json rows = nlohmann::json::array();
  for (const Tally& tally : {present, absent}) {
    const double worst = *std::max_element(tally.ms.begin(), tally.ms.end());
    const double worst_ratio = *std::max_element(tally.ratios.begin(), tally.ratios.end());
    rows.push_back({{"scans", tally.name},
                    {"returns", tally.returns},
                    {"search_ms", {median(tally.ms), worst}},
                    {"over_floor", {median(tally.ratios), worst_ratio}},
                    {"candidates", tally.candidates},
                    {"found", tally.found},
                    {"found_first", tally.first}});
    if (options.json) continue;
    std::printf("%-14s %9.0f | %6.2f / %6.2f | %6.1f / %6.1f | %10.1f\n", tally.name.c_str(), tally.returns,
                median(tally.ms), worst, median(tally.ratios), worst_ratio, tally.candidates);
  }
  if (options.json) {
    std::printf("%s\n", rows.dump(2).c_str());
  } else {
    std::printf("\nthe board is among the candidates in %d of %d scans, the first of them in %d\n",
                present.found, scene_count, present.first);
  }
  return 0;
}

}  // namespace ca2
