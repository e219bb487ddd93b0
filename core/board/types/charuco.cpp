/// ChArUco: a checkerboard whose white squares carry ArUco markers, so that any part of it tells where it is.
/// `columns` x `rows` squares, the top-left one black; ids and markers are those of OpenCV 4.6's
/// CharucoBoard. ArUco moved and changed its interface in OpenCV 4.7: only its dictionaries are used, and
/// only here.
#include <array>
#include <opencv2/aruco/dictionary.hpp>
#include <opencv2/core.hpp>
#include <utility>

#include "core/board/board.h"
#include "core/board/detect/print_search.h"
#include "core/board/types/lattice.h"

namespace ca2 {
namespace {

using Dictionary = cv::aruco::Dictionary;

const Dictionary* find_dictionary(std::string_view name) {
  using namespace cv::aruco;
  static const auto entry = [](const char* text, int id) {
    return std::pair<std::string_view, cv::Ptr<Dictionary>>(text, getPredefinedDictionary(id));
  };
#define CA2_DICTIONARY(name) entry(#name, name)
  static const std::array dictionaries{
      CA2_DICTIONARY(DICT_4X4_50),   CA2_DICTIONARY(DICT_4X4_100),        CA2_DICTIONARY(DICT_4X4_250),
      CA2_DICTIONARY(DICT_4X4_1000), CA2_DICTIONARY(DICT_5X5_50),         CA2_DICTIONARY(DICT_5X5_100),
      CA2_DICTIONARY(DICT_5X5_250),  CA2_DICTIONARY(DICT_5X5_1000),       CA2_DICTIONARY(DICT_6X6_50),
      CA2_DICTIONARY(DICT_6X6_100),  CA2_DICTIONARY(DICT_6X6_250),        CA2_DICTIONARY(DICT_6X6_1000),
      CA2_DICTIONARY(DICT_7X7_50),   CA2_DICTIONARY(DICT_7X7_100),        CA2_DICTIONARY(DICT_7X7_250),
      CA2_DICTIONARY(DICT_7X7_1000), CA2_DICTIONARY(DICT_ARUCO_ORIGINAL),
  };
#undef CA2_DICTIONARY
  // Asked for the same one some 100 000 times a picture.
  thread_local std::pair<std::string_view, const Dictionary*> last;
  if (last.first == name) return last.second;
  for (const auto& [known, dictionary] : dictionaries) {
    if (known == name) return (last = {known, dictionary.get()}).second;
  }
  return nullptr;
}

/// Bit of a marker, row by row from the top-left; true is white. The list holds the four rotations one after
/// the other, each with its bits from the most significant down; the last byte of a rotation is not full.
bool marker_bit(const Dictionary& dictionary, int id, int row, int column) {
  const int total = dictionary.markerSize * dictionary.markerSize;
  const int index = row * dictionary.markerSize + column;
  const int bits_in_byte = std::min(8, total - index / 8 * 8);
  const int byte = dictionary.bytesList.ptr(id)[index / 8];
  return ((byte >> (bits_in_byte - 1 - index % 8)) & 1) != 0;
}

/// Number of white squares before this white one, row by row: the marker's id.
int marker_id(int columns, int column, int row) {
  return row * columns / 2 + column / 2;
}

int marker_count(const Board& board) {
  return board.columns * board.rows / 2;
}

class Charuco final : public BoardType {
 public:
  std::string_view name() const override { return "charuco"; }

  std::vector<std::string> invalid(const Board& board) const override {
    std::vector<std::string> problems;
    // 3 x 4 squares are the least with 6 corners, the least that may stand for the board in a picture.
    check_count(problems, "columns", board.columns, 3);
    check_count(problems, "rows", board.rows, 3);
    check_square(problems, board.square);
    if (problems.empty() && board.columns * board.rows < 12) {
      problems.push_back("a charuco board needs at least 3 x 4 squares");
    }
    if (!(board.marker > 0 && board.marker < board.square)) {
      problems.push_back("marker is " + std::to_string(board.marker) + " m, not between 0 and the square");
    }
    const Dictionary* dictionary = find_dictionary(board.dictionary);
    if (dictionary == nullptr) {
      problems.push_back("dictionary '" + board.dictionary + "' is not one of OpenCV's, like DICT_5X5_100");
    } else if (problems.empty() && marker_count(board) > dictionary->bytesList.rows) {
      problems.push_back("the board needs " + std::to_string(marker_count(board)) + " markers and " +
                         board.dictionary + " has " + std::to_string(dictionary->bytesList.rows));
    }
    return problems;
  }

  std::vector<Eigen::Vector2d> corners(const Board& board) const override {
    return centred_lattice(board.columns - 1, board.rows - 1, board.square);
  }

  Eigen::Vector2d pattern_size(const Board& board) const override {
    return {board.columns * board.square, board.rows * board.square};
  }

  bool black(const Board& board, const Eigen::Vector2d& p) const override {
    const SquareAt at = square_at(board.columns, board.rows, board.square, p);
    if (at.column < 0 || at.row < 0 || at.column >= board.columns || at.row >= board.rows) return false;
    if ((at.column + at.row) % 2 == 0) return true;
    const Dictionary* dictionary = find_dictionary(board.dictionary);
    if (dictionary == nullptr) return false;
    // The marker is centred in its white square and has one black cell of border all round.
    const int cells = dictionary->markerSize + 2;
    const Eigen::Vector2d cell =
        ((at.inside - Eigen::Vector2d::Constant(0.5)) * (board.square / board.marker) +
         Eigen::Vector2d::Constant(0.5)) *
        cells;
    const int column = static_cast<int>(std::floor(cell.x()));
    const int row = static_cast<int>(std::floor(cell.y()));
    if (column < 0 || row < 0 || column >= cells || row >= cells) return false;
    if (column == 0 || row == 0 || column == cells - 1 || row == cells - 1) return true;
    return !marker_bit(*dictionary, marker_id(board.columns, at.column, at.row), row - 1, column - 1);
  }

  bool half_turn_ambiguous(const Board&) const override { return false; }

  std::vector<Corner> find(const Board& board, const Image& grey8) const override {
    const Dictionary* dictionary = find_dictionary(board.dictionary);
    if (dictionary == nullptr) return {};
    const int bits = dictionary->markerSize;
    const double share = board.marker / board.square;
    return find_by_print(board, {bits, share * bits / (bits + 2), 0.5 * (1 - share)}, grey8);
  }
};

}  // namespace

const BoardType& charuco_board() {
  static const Charuco type;
  return type;
}

}  // namespace ca2
