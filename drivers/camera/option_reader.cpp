#include "drivers/camera/option_reader.h"

#include <algorithm>

namespace ca2 {

OptionReader::OptionReader(const SourceOptions& options, std::span<const std::string_view> known)
    : reader_("source") {
  root_.kind = YamlNode::Kind::map;
  for (const auto& [key, value] : options) {
    YamlNode& node = root_.items.emplace_back();
    node.kind = YamlNode::Kind::scalar;
    node.key = key;
    node.text = value;
  }
  const auto driver = options.find("driver");
  reader_.map(&root_, driver == options.end() ? "the source" : "a source of driver " + driver->second, known);
}

std::optional<std::string> OptionReader::text(std::string_view name) {
  return reader_.text(root_.find(name));
}

std::optional<double> OptionReader::number(std::string_view name, double least, double most) {
  const YamlNode* node = root_.find(name);
  // An empty text is no number; the reader of numbers expects what a YAML scalar cannot lack.
  if (node && node->text.empty()) return reader_.text(node), std::nullopt;
  return reader_.number(node, least, most);
}

std::optional<int> OptionReader::integer(std::string_view name, int least, int most) {
  const auto value = reader_.integer(root_.find(name), least, most);
  return value ? std::optional<int>(static_cast<int>(*value)) : std::nullopt;
}

std::optional<bool> OptionReader::boolean(std::string_view name) {
  return reader_.boolean(root_.find(name));
}

std::optional<std::string> OptionReader::choice(std::string_view name,
                                                std::span<const std::string_view> words) {
  const auto value = text(name);
  if (!value || std::find(words.begin(), words.end(), *value) != words.end()) return value;
  reader_.problem(*root_.find(name), "'" + std::string(name) + "' cannot be '" + *value + "'",
                  suggest(*value, words));
  return std::nullopt;
}

std::string OptionReader::require(std::string_view name) {
  if (!root_.find(name)) {
    problem("the source has no '" + std::string(name) + "'");
    return {};
  }
  return text(name).value_or("");
}

void OptionReader::problem(std::string what, std::string hint) {
  reader_.problem(root_, std::move(what), std::move(hint));
}

Result<void> OptionReader::done() const {
  std::vector<Problem> problems = reader_.problems();
  if (problems.empty()) return {};
  // The mapping's place in its file is not known here.
  for (Problem& problem : problems) problem.where = "source";
  return fail(ErrorCode::config, std::move(problems));
}

}  // namespace ca2
