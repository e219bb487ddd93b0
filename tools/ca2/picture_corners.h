/// @file The board's corners in the pictures of a session's cameras, or of a folder.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/board/board.h"
#include "core/types/result.h"

namespace ca2 {

/// One camera's pictures, those without the board too (no corners).
struct PictureCorners {
  std::string camera;
  Board board;
  int width = 0, height = 0;  ///< px
  std::vector<std::string> names;
  std::vector<std::vector<Corner>> corners;  ///< by picture
};

/// `source` is a session (its cache is used; `camera` picks one of its cameras) or a folder of pictures of
/// one camera
/// (`board` is a file with a `board:` key; `camera` is how to call it). Pictures that cannot be read, or of
/// another size than most, are errors.
Result<std::vector<PictureCorners>> read_corners(const std::filesystem::path& source,
                                                 const std::filesystem::path& board,
                                                 const std::string& camera,
                                                 const std::function<void(int done, int total)>& progress);

/// The board of a YAML file with a `board:` key: what `ca2 board` writes, or a whole rig.
Result<Board> read_board(const std::filesystem::path& file);

}  // namespace ca2
