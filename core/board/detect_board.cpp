#include <Eigen/SVD>
#include <algorithm>

#include "core/board/board.h"
#include "core/board/detect/corner_search.h"
#include "core/board/refine/refine_corners.h"

namespace ca2 {
namespace {

/// Do the corners span the board's plane? On a line they would fix no pose.
bool span_plane(const Board& board, const std::vector<Corner>& corners) {
  const std::vector<Eigen::Vector2d> points = board.type->corners(board);
  Eigen::Matrix2Xd p(2, static_cast<Eigen::Index>(corners.size()));
  for (std::size_t i = 0; i < corners.size(); ++i) {
    p.col(static_cast<Eigen::Index>(i)) = points[static_cast<std::size_t>(corners[i].id)];
  }
  p.colwise() -= p.rowwise().mean().eval();
  return p.jacobiSvd().singularValues()[1] > 0.5 * board.square;
}

/// The corners of a board of markers, and those whose markers could not be read but that are next to others.
std::vector<Corner> completed(const Board& board, const Image& grey8, std::vector<Corner> corners) {
  const CornerSearch search(board, grey8);
  while (search.grow(corners, 0.25) > 0) {
  }
  std::sort(corners.begin(), corners.end(), [](const Corner& a, const Corner& b) { return a.id < b.id; });
  return corners;
}

}  // namespace

std::vector<Corner> detect_board(const Board& board, const Image& image) {
  Image converted;
  const Image& grey8 = as_grey8(image, converted);
  const GreyView grey(image);
  const bool has_markers = !board.type->repeats(board);
  std::vector<Corner> found = board.type->find(board, grey8);
  if (!found.empty() && has_markers) found = completed(board, grey8, found);
  if (found.size() < 6) return {};
  std::vector<Corner> corners = refine_corners(board, grey, found);
  // What is printed in small squares hides corners from the search, or moves them: refined neighbours know
  // better where they are.
  while (has_markers && corners.size() >= 6) {
    std::vector<Corner> more = CornerSearch(board, grey8).with_neighbours(corners);
    if (more.size() > corners.size()) more = refine_corners(board, grey, more);
    if (more.size() <= corners.size()) break;
    corners = std::move(more);
  }
  // A board most of whose corners do not look like corners is not a board.
  if (corners.size() < 6 || 2 * corners.size() < found.size() || !span_plane(board, corners)) return {};
  std::sort(corners.begin(), corners.end(), [](const Corner& a, const Corner& b) { return a.id < b.id; });
  return corners;
}

}  // namespace ca2
