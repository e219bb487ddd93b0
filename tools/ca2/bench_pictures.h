/// @file Generated pictures to search boards in.
#pragma once

#include <random>
#include <string>
#include <vector>

#include "core/board/board.h"

namespace ca2 {

struct BenchPicture {
  std::string kind;
  Image image;  ///< 8-bit grey
};

/// Where a board is held.
struct BoardPlaces {
  double off_axis = 0;  ///< rad from the optical axis, at most
  double nearest = 0;   ///< m
  double farthest = 0;  ///< m
};

/// The board whole in the picture, tilted up to 60 degrees.
Pose random_board_pose(const Board& board, const Camera& camera, const BoardPlaces& places,
                       std::mt19937_64& random);

/// The board before clutter.
Image board_picture(const Board& board, const Camera& camera, const Pose& T_camera_board,
                    std::mt19937_64& random);

/// `count` of them, anywhere in `places`.
std::vector<BenchPicture> board_pictures(const std::string& kind, const Board& board, const Camera& camera,
                                         const BoardPlaces& places, int count, std::mt19937_64& random);

/// What a board is looked for in and with, by the name of its rig.
struct BenchCamera {
  const char* name;
  Camera camera;
  BoardPlaces places;
};

/// A tracking camera's fisheye, an industrial camera, a large one.
std::vector<BenchCamera> bench_cameras();

/// A checkerboard of 8 x 6 corners of 40 mm.
Board bench_board();

/// That, and one of every other type, of about its size; only types that this build has.
std::vector<Board> bench_boards();

/// What searches stumble over: texture, foliage, a keyboard, blinds, windows, a checkered floor; `each` of
/// every kind.
std::vector<BenchPicture> hard_pictures(int width, int height, int each, std::mt19937_64& random);

}  // namespace ca2
