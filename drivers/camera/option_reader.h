/// @file Reads a driver's typed values out of a `source:` mapping and collects every problem.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/io/yaml_reader.h"
#include "core/session/rig.h"

namespace ca2 {

/// Getters answer nothing for an option that is absent, or wrong (done() tells).
class OptionReader {
 public:
  /// `known` are the driver's options; others are problems.
  OptionReader(const SourceOptions& options, std::span<const std::string_view> known);

  std::optional<std::string> text(std::string_view name);
  std::optional<double> number(std::string_view name, double least, double most);
  std::optional<int> integer(std::string_view name, int least, int most);
  std::optional<bool> boolean(std::string_view name);
  /// One of these words.
  std::optional<std::string> choice(std::string_view name, std::span<const std::string_view> words);
  /// text() of an option that must be there.
  std::string require(std::string_view name);

  void problem(std::string what, std::string hint = {});
  /// ErrorCode::config with every problem there was.
  Result<void> done() const;

 private:
  YamlNode root_;
  YamlReader reader_;
};

}  // namespace ca2
