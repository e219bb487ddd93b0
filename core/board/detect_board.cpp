#include "core/board/board.h"
#include "core/board/refine/refine_corners.h"

namespace ca2 {

std::vector<Corner> detect_board(const Board& board, const Image& image) {
  const std::vector<Corner> found = board.type->find(board, to_grey8(image));
  if (found.empty()) return {};
  std::vector<Corner> corners = refine_corners(board, to_grey(image), found);
  // A board most of whose corners do not look like corners is not a board.
  if (corners.size() < 4 || 4 * corners.size() < 3 * found.size()) return {};
  return corners;
}

}  // namespace ca2
