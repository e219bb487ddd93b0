/// @file Numbers of things in words.
#pragma once

#include <concepts>
#include <string>
#include <string_view>

namespace ca2 {

/// "1 view", "2 views".
std::string counted(std::integral auto count, std::string_view one) {
  return std::to_string(count) + " " + std::string(one) + (count == 1 ? "" : "s");
}

}  // namespace ca2
