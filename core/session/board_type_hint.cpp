#include "core/session/board_type_hint.h"

#include <vector>

#include "core/board/board.h"
#include "core/board/left_out.h"
#include "core/io/yaml_reader.h"

namespace ca2 {

std::string board_type_hint(std::string_view name) {
  if (const std::string_view option = board_type_option(name); !option.empty())
    return "this build was made without it: configure it with -D" + std::string(option) + "=ON";
  std::vector<std::string_view> names;
  for (const BoardType* known : board_types()) names.push_back(known->name());
  return suggest(name, names);
}

}  // namespace ca2
