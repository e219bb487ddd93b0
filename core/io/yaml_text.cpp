#include "core/io/yaml_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace ca2 {
namespace {

/// A word that no YAML reader, 1.1 or 1.2, takes for a number, a truth value, a null or syntax.
bool safe_plain(std::string_view text) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  const auto inner = [&](char c) {
    return letter(c) || (c >= '0' && c <= '9') || c == '-' || c == '.' || c == '/';
  };
  if (text.empty() || !letter(text[0]) || !std::all_of(text.begin(), text.end(), inner)) return false;
  std::string lower(text);
  for (char& c : lower) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  static constexpr std::string_view special[] = {"y",  "n",   "yes",  "no",   "true", "false",
                                                 "on", "off", "null", "none", "nan",  "inf"};
  return std::find(std::begin(special), std::end(special), lower) == std::end(special);
}

}  // namespace

std::string exact(double value) {
  if (std::isnan(value)) return ".nan";
  if (std::isinf(value)) return value < 0 ? "-.inf" : ".inf";
  std::array<char, 40> buffer;
  const auto end =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::general, 17).ptr;
  return std::string(buffer.data(), end);
}

std::string exact_list(const double* values, std::size_t count) {
  std::string text = "[";
  for (std::size_t i = 0; i < count; ++i) text += (i ? ", " : "") + exact(values[i]);
  return text + "]";
}

std::string yaml_string(std::string_view text) {
  if (safe_plain(text)) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      quoted += '\\';
      quoted += c;
    } else if (c == '\n') {
      quoted += "\\n";
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      static constexpr char digits[] = "0123456789abcdef";
      quoted += "\\x";
      quoted += digits[(c >> 4) & 15];
      quoted += digits[c & 15];
    } else {
      quoted += c;
    }
  }
  return quoted + '"';
}

}  // namespace ca2
