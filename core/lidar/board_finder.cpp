#include <algorithm>

#include "core/lidar/board_candidate.h"
#include "core/lidar/board_patch.h"
#include "core/lidar/planar_regions.h"
#include "core/lidar/projection.h"
#include "core/lidar/ring_image.h"

namespace ca2 {
namespace {

/// Two seeds on one surface give one candidate: the better one.
bool same_place(const BoardCandidate& a, const BoardCandidate& b, double short_side) {
  return (a.T_lidar_board.t - b.T_lidar_board.t).norm() < 0.4 * short_side &&
         a.plane.normal.dot(b.plane.normal) > 0.8;
}

}  // namespace

std::vector<BoardCandidate> find_board_candidates(const Scan& scan, const Board& board,
                                                  const FinderOptions& options) {
  const Outline extent = board.extent();
  if (scan.empty() || !(extent.width > 0) || !(extent.height > 0)) return {};
  const Projection projection = project_by_id(scan);
  const RingImage image = make_ring_image(projection, scan);
  const PlanarRegions planar = find_planar_regions(image, extent.width, extent.height);
  const PatchContext context{scan, projection, image, extent.width, extent.height, planar.noise};
  std::vector<BoardCandidate> judged, kept;
  for (const PlanarRegion& region : planar.regions) {
    if (auto candidate = judge_region(context, region)) judged.push_back(*std::move(candidate));
  }
  std::stable_sort(judged.begin(), judged.end(),
                   [](const auto& a, const auto& b) { return a.score > b.score; });
  for (BoardCandidate& candidate : judged) {
    if (static_cast<int>(kept.size()) >= options.max_candidates) break;
    const bool known = std::any_of(kept.begin(), kept.end(), [&](const BoardCandidate& other) {
      return same_place(candidate, other, std::min(extent.width, extent.height));
    });
    if (known) continue;
    if (board.outline) {
      candidate.crossings = find_edge_crossings(
          scan, projection,
          {candidate.plane, candidate.T_lidar_board, extent.width, extent.height, candidate.rms});
    }
    kept.push_back(std::move(candidate));
  }
  return kept;
}

}  // namespace ca2
