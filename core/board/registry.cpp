#include <array>

#include "core/board/board.h"
#include "core/board/left_out.h"

namespace ca2 {

#define CA2_BOARD_LEFT_OUT(name, option)
#define CA2_BOARD_TYPE(name) const BoardType& name##_board();
#include "core/board/boards.def"
#undef CA2_BOARD_TYPE

std::span<const BoardType* const> board_types() {
  static const std::array types{
#define CA2_BOARD_TYPE(name) &name##_board(),
#include "core/board/boards.def"
#undef CA2_BOARD_TYPE
  };
  return types;
}
#undef CA2_BOARD_LEFT_OUT

const BoardType* find_board_type(std::string_view name) {
  for (const BoardType* type : board_types()) {
    if (type->name() == name) return type;
  }
  return nullptr;
}

std::string_view board_type_option(std::string_view name) {
  struct LeftOut {
    std::string_view name, option;
  };
#define CA2_BOARD_TYPE(name)
#define CA2_BOARD_LEFT_OUT(name, option) {#name, #option},
  static const std::vector<LeftOut> left_out{
#include "core/board/boards.def"
  };
#undef CA2_BOARD_TYPE
#undef CA2_BOARD_LEFT_OUT
  for (const LeftOut& type : left_out) {
    if (type.name == name) return type.option;
  }
  return {};
}

Outline Board::extent() const {
  if (outline) return *outline;
  const Eigen::Vector2d size = type->pattern_size(*this);
  return {size.x(), size.y(), Eigen::Vector2d::Zero()};
}

}  // namespace ca2
