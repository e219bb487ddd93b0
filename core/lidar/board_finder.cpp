#include <algorithm>

#include "core/lidar/board_candidate.h"
#include "core/lidar/board_patch.h"
#include "core/lidar/planar_regions.h"
#include "core/lidar/projection.h"
#include "core/lidar/ring_image.h"

namespace ca2 {
namespace {

/// More looks than candidates are judged: some of them are dismissed then, or
/// turn out to be one.
constexpr int kSpareLooks = 4;

/// Two seeds on one surface give one candidate: the better one.
struct PlaceInSpace {
  Eigen::Vector3d centre, normal;
};
bool taken(std::vector<PlaceInSpace>& places, const PlaceInSpace& place, double short_side) {
  const bool known = std::any_of(places.begin(), places.end(), [&](const PlaceInSpace& other) {
    return (place.centre - other.centre).norm() < 0.4 * short_side && place.normal.dot(other.normal) > 0.8;
  });
  if (!known) places.push_back(place);
  return known;
}

template <class List>
void sort_by_score(List& list) {
  std::stable_sort(list.begin(), list.end(), [](const auto& a, const auto& b) { return a.score > b.score; });
}

}  // namespace

struct BoardFinder::Memory {
  Projection projection;
  RingImage image;
  RegionMemory regions;
};

BoardFinder::BoardFinder(Board board, const FinderOptions& options)
    : board_(std::move(board)), options_(options), memory_(std::make_unique<Memory>()) {}
BoardFinder::~BoardFinder() = default;
BoardFinder::BoardFinder(BoardFinder&&) noexcept = default;
BoardFinder& BoardFinder::operator=(BoardFinder&&) noexcept = default;

std::vector<BoardCandidate> BoardFinder::find(const Scan& scan) {
  const Outline extent = board_.extent();
  if (scan.empty() || !(extent.width > 0) || !(extent.height > 0)) return {};
  const double short_side = std::min(extent.width, extent.height);
  Projection& projection = memory_->projection;
  RingImage& image = memory_->image;
  projection = project_by_id(scan, std::move(projection));
  image = make_ring_image(projection, scan, std::move(image));
  const PlanarRegions planar = find_planar_regions(image, extent.width, extent.height, memory_->regions);
  const PatchContext context{scan, projection, image, extent.width, extent.height, planar.noise};

  std::vector<FirstLook> looks;
  for (const PlanarRegion& region : planar.regions) {
    if (auto look = look_at_region(context, region)) looks.push_back(*std::move(look));
  }
  sort_by_score(looks);
  std::vector<BoardCandidate> judged, kept;
  std::vector<PlaceInSpace> looked_at, found_at;
  for (const FirstLook& look : looks) {
    if (static_cast<int>(looked_at.size()) >= options_.max_candidates + kSpareLooks) break;
    if (taken(looked_at, {centre_of(look.placed), look.placed.frame.plane.normal}, short_side)) continue;
    if (auto candidate = judge_look(context, look)) judged.push_back(*std::move(candidate));
  }
  sort_by_score(judged);
  for (BoardCandidate& candidate : judged) {
    if (static_cast<int>(kept.size()) >= options_.max_candidates) break;
    if (taken(found_at, {candidate.T_lidar_board.t, candidate.plane.normal}, short_side)) continue;
    if (board_.outline) {
      candidate.crossings = find_edge_crossings(scan, projection,
                                                {candidate.plane, candidate.T_lidar_board, extent.width,
                                                 extent.height, candidate.rms, candidate.covered});
    }
    if (projection.beams) {
      candidate.beam_height = projection.height;
      candidate.found_ring = projection.found_ring;
    }
    kept.push_back(std::move(candidate));
  }
  return kept;
}

std::vector<BoardCandidate> find_board_candidates(const Scan& scan, const Board& board,
                                                  const FinderOptions& options) {
  return BoardFinder(board, options).find(scan);
}

}  // namespace ca2
