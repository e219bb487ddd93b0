/// @file Text from a printf format, of any length.
#pragma once

#include <cstdio>
#include <string>

namespace ca2 {

/// What printf would print. The format is a literal of ours, never input.
template <class... Values>
std::string formatted(const char* format, Values... values) {
  const int size = std::snprintf(nullptr, 0, format, values...);
  std::string text(size > 0 ? static_cast<std::size_t>(size) + 1 : 0, '\0');
  std::snprintf(text.data(), text.size(), format, values...);
  if (!text.empty()) text.pop_back();
  return text;
}

}  // namespace ca2
