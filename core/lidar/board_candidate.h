/// @file Pieces of a scan that may be the board.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/board/board.h"
#include "core/geometry/plane.h"
#include "core/geometry/pose.h"
#include "core/lidar/edge_crossings.h"
#include "core/types/result.h"
#include "core/types/scan.h"

namespace ca2 {

/// A planar patch of the board's size. `returns` index the scan.
struct BoardCandidate {
  Plane plane;                          ///< sensor frame, robust fit over `returns`
  Pose T_lidar_board;                   ///< the board rectangle fitted to the patch: centre of
                                        ///< the plate, x and y along its sides (the half and, for
                                        ///< a square, quarter turns are arbitrary), z away from
                                        ///< the sensor
  std::vector<std::uint32_t> returns;   ///< those on the board: within the
                                        ///< plane's noise and inside its rim, not covered
  std::vector<std::uint32_t> covered;   ///< on what lies on the board (a hand), and beside it; rising
  double rms = 0;                       ///< m, of the `returns`' distances along the ray to the plane
  std::vector<EdgeCrossing> crossings;  ///< of the plate's rim; none where the board has no outline
  std::vector<float> beam_height;       ///< m, by ring: Projection::height; empty: the scan has no rings
  /// By return of the scan, Projection::found_ring; null: those that the scan names.
  std::shared_ptr<const std::vector<std::uint16_t>> found_ring;
  double score = 0;  ///< 0..1: how much it looks like the board; only ranks candidates
  std::string why;   ///< what speaks for and against it, for the report
};

struct FinderOptions {
  int max_candidates = 8;
};

/// Looks for the board in single scans with nothing else known: planar patches
/// of the board's physical size that stand free of what is behind and beside
/// them. Needs neither ring nor column; uses them where they are. NaN points
/// and zero points are ignored. One for a stream of scans keeps its memory;
/// what it finds in a scan depends on that scan alone.
class BoardFinder {
 public:
  explicit BoardFinder(Board board, const FinderOptions& options = {});
  ~BoardFinder();
  BoardFinder(BoardFinder&&) noexcept;
  BoardFinder& operator=(BoardFinder&&) noexcept;

  /// Best first; may be empty. Deterministic.
  std::vector<BoardCandidate> find(const Scan& scan);

 private:
  struct Memory;
  Board board_;
  FinderOptions options_;
  std::unique_ptr<Memory> memory_;
};

/// The same for one scan.
std::vector<BoardCandidate> find_board_candidates(const Scan& scan, const Board& board,
                                                  const FinderOptions& options = {});

/// The published way (Ca2Lib): a circular patch of the projection by ID around
/// a pixel that a person picked, RANSAC plane in it, refit on the inliers.
/// `row` is the ring, `column` the column of the projection.
Result<BoardCandidate> fit_picked_patch(const Scan& scan, const Board& board, int row, int column,
                                        double radius);

}  // namespace ca2
