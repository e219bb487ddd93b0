/// @file Reads typed values out of a YAML tree and collects every problem with its place.
#pragma once

#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/io/yaml.h"

namespace ca2 {

/// Every getter takes the value's node, which may be nullptr (absent: nothing is read and nothing reported,
/// `require` is what reports), and answers nothing after it reported a problem.
class YamlReader {
 public:
  explicit YamlReader(std::string file) : file_(std::move(file)) {}

  void problem(const YamlNode& at, std::string what, std::string hint = {});
  /// At the key of a map's value rather than at the value.
  void key_problem(const YamlNode& at, std::string what, std::string hint = {});
  void problem(Problem problem) { problems_.push_back(std::move(problem)); }
  const std::vector<Problem>& problems() const { return problems_; }

  /// Is it a map? Keys other than `known` are reported with the nearest known one. `what` names the map.
  bool map(const YamlNode* node, std::string_view what, std::span<const std::string_view> known);
  bool map(const YamlNode* node, std::string_view what, std::initializer_list<std::string_view> known) {
    return map(node, what, std::span(known.begin(), known.size()));
  }
  /// A map whose keys are free.
  bool map(const YamlNode* node, std::string_view what);
  bool sequence(const YamlNode* node, std::string_view what);
  /// The value of a key; reports where it is missing.
  const YamlNode* require(const YamlNode& map, std::string_view key, std::string_view what);

  std::optional<double> number(const YamlNode* node, double least, double most);
  /// Of metres: who wrote millimetres is told.
  std::optional<double> length(const YamlNode* node, double least, double most);
  std::optional<long long> integer(const YamlNode* node, long long least, long long most);
  std::optional<bool> boolean(const YamlNode* node);
  /// Not empty.
  std::optional<std::string> text(const YamlNode* node);
  /// A sequence of numbers in [-most, most]; any count if `count` is 0.
  std::optional<std::vector<double>> numbers(const YamlNode* node, std::size_t count, double most);

 private:
  std::string file_;
  std::vector<Problem> problems_;
};

/// The number that a plain YAML scalar spells: decimal, and .nan .inf -.inf. Nothing for anything else.
std::optional<double> yaml_number(const YamlNode& node);

/// "did you mean 'rows'?" or "known are: a, b, c".
std::string suggest(std::string_view word, std::span<const std::string_view> known);

}  // namespace ca2
