/// @file The search for the board in a camera's stream of pictures.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/capture/observation.h"

namespace ca2 {

/// Tracks the board from the picture before, which takes a fraction of a search; where that fails, searches
/// round the place where it was, then everywhere. Where it has not been for a second, some pictures a second
/// are searched and the others spared. The corners are good to a twentieth of a pixel or so, which
/// tells motion from stillness; a view's are refined when it is stored. One per camera; the same pictures
/// give the same corners. Hosts with no time for a picture leave it out (CameraObservation::searched).
class CameraDetector {
 public:
  CameraDetector(Board board, int camera) : board_(std::move(board)), camera_(camera) {}

  CameraObservation detect(std::int64_t time, std::shared_ptr<const Image> image);

 private:
  bool spares(std::int64_t time) const;
  std::vector<Corner> find(const Image& image);
  /// The last picture's corners, moved on as they did before.
  std::vector<Corner> expected() const;
  std::vector<Corner> search_region(const Image& grey8) const;

  Board board_;
  int camera_;
  std::vector<Corner> last_, before_;                       ///< of the two pictures before; empty: not seen
  std::optional<std::int64_t> away_since_, last_searched_;  ///< ns
};

}  // namespace ca2
