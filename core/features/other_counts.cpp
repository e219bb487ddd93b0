#include "core/features/other_counts.h"

#include <algorithm>
#include <utility>

#include "core/io/files.h"

namespace ca2 {
namespace {

/// The likeliest first: squares for corners, corners for squares, a slip in one.
constexpr std::pair<int, int> steps[] = {{-1, -1}, {1, 1}, {-1, 0}, {0, -1}, {1, 0}, {0, 1}};
constexpr std::size_t most_pictures = 5;

}  // namespace

std::optional<OtherCounts> find_other_counts(const Board& board, std::span<const SensorFile> files,
                                             const std::string& sensor) {
  if (!board.type->repeats(board)) return std::nullopt;
  std::vector<const SensorFile*> pictures;
  for (const SensorFile& file : files) {
    if (file.is_image && file.sensor == sensor && !file.error) pictures.push_back(&file);
  }
  const std::size_t count = std::min(pictures.size(), most_pictures);
  for (std::size_t i = 0; i < count; ++i) {
    const SensorFile& file = *pictures[i * pictures.size() / count];
    const Result<Image> image = read_png(file.path);
    if (!image) continue;
    for (const auto& [columns, rows] : steps) {
      Board other = board;
      other.columns += columns;
      other.rows += rows;
      other.outline.reset();
      if (!other.type->invalid(other).empty()) continue;
      if (!detect_board(other, *image).empty()) return OtherCounts{other.columns, other.rows, file.path};
    }
  }
  return std::nullopt;
}

}  // namespace ca2
