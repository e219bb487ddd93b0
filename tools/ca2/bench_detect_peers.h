/// @file Searches of others for the boards that `ca2 bench detect` measures.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/board/board.h"

namespace ca2 {

struct PeerSearch {
  std::string name;
  std::function<bool(const Board&, const Image& grey8)> found;
  bool endless = false;  ///< may take minutes on texture
};

/// OpenCV's or libapriltag's, by the type of the board.
std::vector<PeerSearch> peer_searches(const Board& board);

}  // namespace ca2
