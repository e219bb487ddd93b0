/// @file What tests skip in builds without some of the options.
#pragma once

#include <string_view>

#include "core/board/board.h"

namespace ca2::test {

/// Is it a shipped scenario whose board this build was made without?
inline bool left_out(std::string_view scenario) {
  return scenario == "os0_manta" && !find_board_type("charuco");
}

}  // namespace ca2::test
