#include "core/io/yaml_reader.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/io/yaml_text.h"

namespace ca2 {
namespace {

/// Levenshtein's distance.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t changed = diagonal + (a[i - 1] != b[j - 1]);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, changed});
    }
  }
  return row[b.size()];
}

/// A value in a message: short, on one line.
std::string shown(std::string_view text) {
  std::string word(text.substr(0, 60));
  for (char& c : word) {
    if (static_cast<unsigned char>(c) < ' ' || c == 0x7f) c = '?';
  }
  return "'" + word + (text.size() > 60 ? "...'" : "'");
}

/// Bounds for people: 0.04, not 0.040000000000000001.
std::string brief(double value) {
  char buffer[32];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr};
}

std::string named(const YamlNode& node) {
  return node.key.empty() ? std::string("the value") : shown(node.key);
}

}  // namespace

std::string suggest(std::string_view word, std::span<const std::string_view> known) {
  std::string_view nearest;
  std::size_t least = std::numeric_limits<std::size_t>::max();
  // A word that long is no slip of the finger, and its distance costs time.
  for (const std::string_view candidate : word.size() > 64 ? std::span<const std::string_view>() : known) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < least) {
      least = distance;
      nearest = candidate;
    }
  }
  if (!nearest.empty() && least <= 1 + nearest.size() / 3) return "did you mean " + shown(nearest) + "?";
  std::string list;
  for (const std::string_view candidate : known) list += (list.empty() ? "" : ", ") + std::string(candidate);
  return list.empty() ? "" : "known are: " + list;
}

std::optional<double> yaml_number(const YamlNode& node) {
  if (!node.is_scalar() || node.quoted) return std::nullopt;
  std::string_view text = node.text;
  if (text == ".nan" || text == ".NaN" || text == ".NAN") return std::numeric_limits<double>::quiet_NaN();
  const bool negative = text.front() == '-';
  if (text.front() == '+') text.remove_prefix(1);
  const std::string_view magnitude = negative ? text.substr(1) : text;
  if (magnitude == ".inf" || magnitude == ".Inf" || magnitude == ".INF") {
    return negative ? -std::numeric_limits<double>::infinity() : std::numeric_limits<double>::infinity();
  }
  // from_chars would take "inf" and "nan", which are words in YAML, and a second sign.
  if (magnitude.empty() ||
      !(magnitude.front() == '.' || (magnitude.front() >= '0' && magnitude.front() <= '9'))) {
    return std::nullopt;
  }
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end != text.data() + text.size() || error == std::errc::invalid_argument) return std::nullopt;
  if (error == std::errc::result_out_of_range) return std::numeric_limits<double>::infinity();
  return value;
}

void YamlReader::problem(const YamlNode& at, std::string what, std::string hint) {
  problems_.push_back({file_ + ":" + std::to_string(at.line) + ":" + std::to_string(at.column),
                       std::move(what), std::move(hint)});
}

void YamlReader::key_problem(const YamlNode& at, std::string what, std::string hint) {
  problems_.push_back({file_ + ":" + std::to_string(at.key_line) + ":" + std::to_string(at.key_column),
                       std::move(what), std::move(hint)});
}

bool YamlReader::map(const YamlNode* node, std::string_view what) {
  if (!node) return false;
  if (node->is_map()) return true;
  problem(*node, std::string(what) + " must be a mapping of keys to values");
  return false;
}

bool YamlReader::map(const YamlNode* node, std::string_view what, std::span<const std::string_view> known) {
  if (!map(node, what)) return false;
  for (const YamlNode& item : node->items) {
    if (std::find(known.begin(), known.end(), item.key) != known.end()) continue;
    key_problem(item, "unknown key " + shown(item.key) + " in " + std::string(what),
                suggest(item.key, known));
  }
  return true;
}

bool YamlReader::sequence(const YamlNode* node, std::string_view what) {
  if (!node) return false;
  if (node->is_sequence()) return true;
  problem(*node, std::string(what) + " must be a list");
  return false;
}

const YamlNode* YamlReader::require(const YamlNode& map, std::string_view key, std::string_view what) {
  const YamlNode* node = map.find(key);
  if (!node) problem(map, std::string(what) + " has no key '" + std::string(key) + "'");
  return node;
}

std::optional<double> YamlReader::number(const YamlNode* node, double least, double most) {
  if (!node) return std::nullopt;
  const std::optional<double> value = yaml_number(*node);
  if (!value) {
    problem(*node,
            named(*node) + " must be a number" + (node->is_scalar() ? ", not " + shown(node->text) : ""));
  } else if (!std::isfinite(*value)) {
    problem(*node, named(*node) + " must be a finite number, not " + shown(node->text));
  } else if (*value < least || *value > most) {
    problem(*node, named(*node) + " must be from " + brief(least) + " to " + brief(most) + ", not " +
                       shown(node->text));
  } else {
    return value;
  }
  return std::nullopt;
}

std::optional<double> YamlReader::length(const YamlNode* node, double least, double most) {
  const std::optional<double> value = node ? yaml_number(*node) : std::nullopt;
  if (!value || !std::isfinite(*value) || (*value >= least && *value <= most)) {
    return number(node, least, most);
  }
  const double metres = *value / 1000;
  problem(
      *node,
      named(*node) + " must be from " + brief(least) + " to " + brief(most) + " m, not " + shown(node->text),
      metres >= least && metres <= most ? "are these millimetres? Write " + brief(metres) : "");
  return std::nullopt;
}

std::optional<long long> YamlReader::integer(const YamlNode* node, long long least, long long most) {
  if (!node) return std::nullopt;
  long long value = 0;
  const char* end = node->text.data() + node->text.size();
  const auto [stop, error] = std::from_chars(node->text.data(), end, value);
  if (!node->is_scalar() || node->quoted || stop != end || error == std::errc::invalid_argument) {
    problem(*node, named(*node) + " must be a whole number" +
                       (node->is_scalar() ? ", not " + shown(node->text) : ""));
    return std::nullopt;
  }
  if (error != std::errc() || value < least || value > most) {
    problem(*node, named(*node) + " must be from " + std::to_string(least) + " to " + std::to_string(most) +
                       ", not " + shown(node->text));
    return std::nullopt;
  }
  return value;
}

std::optional<bool> YamlReader::boolean(const YamlNode* node) {
  if (!node) return std::nullopt;
  if (node->is_scalar() && !node->quoted && (node->text == "true" || node->text == "false")) {
    return node->text == "true";
  }
  problem(*node, named(*node) + " must be true or false");
  return std::nullopt;
}

std::optional<std::string> YamlReader::text(const YamlNode* node) {
  if (!node) return std::nullopt;
  if (node->is_scalar() && !node->text.empty()) return node->text;
  problem(*node, named(*node) + " must be a text that is not empty");
  return std::nullopt;
}

std::optional<std::vector<double>> YamlReader::numbers(const YamlNode* node, std::size_t count, double most) {
  if (!node) return std::nullopt;
  if (!node->is_sequence() || (count != 0 && node->items.size() != count)) {
    problem(*node, named(*node) + " must be a list of " + (count ? std::to_string(count) + " " : "") +
                       "numbers" +
                       (node->is_sequence() ? ", not of " + std::to_string(node->items.size()) : ""));
    return std::nullopt;
  }
  std::vector<double> values;
  for (const YamlNode& item : node->items) {
    if (const auto value = number(&item, -most, most)) values.push_back(*value);
  }
  if (values.size() != node->items.size()) return std::nullopt;
  return values;
}

}  // namespace ca2
