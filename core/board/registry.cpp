#include <array>

#include "core/board/board.h"
#include "core/board/board_type_hint.h"
#include "core/io/yaml_reader.h"

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

std::string board_type_hint(std::string_view name) {
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
    if (type.name == name) {
      return "this build was made without it: configure it with -D" + std::string(type.option) + "=ON";
    }
  }
  std::vector<std::string_view> names;
  for (const BoardType* known : board_types()) names.push_back(known->name());
  return suggest(name, names);
}

Outline Board::extent() const {
  if (outline) return *outline;
  const Eigen::Vector2d size = type->pattern_size(*this);
  return {size.x(), size.y(), Eigen::Vector2d::Zero()};
}

}  // namespace ca2
