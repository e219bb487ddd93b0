#include "core/board/board.h"

namespace ca2 {

std::vector<Corner> detect_board(const Board& board, const Image& image) {
  return board.type->find(board, to_grey8(image));
}

}  // namespace ca2
