#include <Eigen/SVD>

#include "core/board/board.h"
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

}  // namespace

std::vector<Corner> detect_board(const Board& board, const Image& image) {
  const std::vector<Corner> found = board.type->find(board, to_grey8(image));
  if (found.size() < 6) return {};
  std::vector<Corner> corners = refine_corners(board, to_grey(image), found);
  // A board most of whose corners do not look like corners is not a board.
  if (corners.size() < 6 || 2 * corners.size() < found.size() || !span_plane(board, corners)) return {};
  return corners;
}

}  // namespace ca2
