/// @file The search for the board in a camera's stream of pictures.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "core/capture/observation.h"

namespace ca2 {

/// Looks first where the board was in the picture before, which takes a fraction of the time; then
/// everywhere. One per camera; the same pictures give the same corners. Hosts with no time for a picture
/// leave it out (CameraObservation::searched).
class CameraDetector {
 public:
  CameraDetector(Board board, int camera) : board_(std::move(board)), camera_(camera) {}

  CameraObservation detect(std::int64_t time, std::shared_ptr<const Image> image);

 private:
  struct Region {
    int x = 0, y = 0, width = 0, height = 0;  ///< px
  };
  std::optional<Region> predict(const Image& image) const;

  Board board_;
  int camera_;
  std::vector<Corner> last_, before_;  ///< of the two pictures before; empty: not seen
};

}  // namespace ca2
