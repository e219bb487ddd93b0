#include "core/capture/picture_pairs.h"

#include <algorithm>
#include <cstdlib>

namespace ca2 {
namespace {

using Pictures = std::vector<const CameraObservation*>;

// Stamps of one trigger differ by what hosts take to notice.
constexpr std::int64_t together = 2'000'000;  // ns

bool has_partner(const Pictures& others, std::int64_t time) {
  return others.empty() || std::any_of(others.begin(), others.end(), [&](const CameraObservation* other) {
           return std::abs(other->time - time) <= together;
         });
}

}  // namespace

void keep_pairs(std::vector<Pictures>& cameras) {
  std::vector<Pictures> pairs;
  for (const Pictures& pictures : cameras) {
    Pictures& kept = pairs.emplace_back();
    for (const CameraObservation* picture : pictures) {
      if (std::all_of(cameras.begin(), cameras.end(),
                      [&](const Pictures& others) { return has_partner(others, picture->time); }))
        kept.push_back(picture);
    }
    if (2 * kept.size() < pictures.size()) return;  // no common trigger
  }
  cameras = std::move(pairs);
}

}  // namespace ca2
