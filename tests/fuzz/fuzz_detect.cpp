#include <algorithm>

#include "core/board/board.h"
#include "tests/fuzz/fuzz_target.h"

namespace ca2::fuzz {
namespace {

struct Header {
  std::uint8_t board, width;
};

std::vector<Board> boards() {
  std::vector<Board> out;
  for (const BoardType* type : board_types()) {
    Board board;
    board.type = type;
    board.columns = 4;
    board.rows = 3;
    board.square = 0.05;
    board.marker = 0.0375;
    board.spacing = 0.3;
    if (type->invalid(board).empty()) out.push_back(board);
  }
  return out;
}

}  // namespace

/// Each board from the front, about as small as it can be found: the board, the picture's width, its pixels.
std::vector<std::string> seeds() {
  std::vector<std::string> out;
  const std::vector<Board> all = boards();
  for (std::size_t b = 0; b < all.size(); ++b) {
    for (const int width : {48, 72}) {
      const int height = 3 * width / 4;
      const Eigen::Vector2d size = all[b].type->pattern_size(all[b]);
      const double scale = 1.25 * std::max(size.x() / width, size.y() / height);
      std::string picture{static_cast<char>(b), static_cast<char>(width)};
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
          const Eigen::Vector2d p(scale * (x - 0.5 * width), scale * (y - 0.5 * height));
          picture += static_cast<char>(all[b].type->black(all[b], p) ? 30 : 200);
        }
      }
      out.push_back(picture);
    }
  }
  return out;
}

}  // namespace ca2::fuzz

/// Whatever a picture shows, corners are the board's, each once, inside the picture.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace ca2;
  using fuzz::require;
  static const std::vector<Board> boards = fuzz::boards();
  if (size < sizeof(fuzz::Header) || data[1] == 0) return 0;
  const Board& board = boards[data[0] % boards.size()];
  Image image;
  image.width = data[1];
  image.height = static_cast<int>((size - sizeof(fuzz::Header)) / data[1]);
  image.channels = 1;
  image.bits = 8;
  if (image.height == 0) return 0;
  const std::uint8_t* pixels = data + sizeof(fuzz::Header);
  image.bytes.assign(pixels, pixels + image.width * image.height);
  const auto count = static_cast<int>(board.type->corners(board).size());
  std::vector<int> ids;
  for (const Corner& corner : detect_board(board, image)) {
    require(corner.id >= 0 && corner.id < count, "a corner that the board has not");
    require(corner.pixel.allFinite() && corner.covariance.allFinite(), "no place");
    require(corner.pixel.x() > -1 && corner.pixel.y() > -1 && corner.pixel.x() < image.width &&
                corner.pixel.y() < image.height,
            "a corner beyond the picture");
    ids.push_back(corner.id);
  }
  std::sort(ids.begin(), ids.end());
  require(std::adjacent_find(ids.begin(), ids.end()) == ids.end(), "a corner that is there twice");
  return 0;
}
