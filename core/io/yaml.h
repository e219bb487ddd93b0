/// @file YAML as a tree with the place of everything in it, refused where it is hostile. yaml-cpp stays in
/// the .cpp.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/types/result.h"

namespace ca2 {

/// A value of a YAML document. Scalars are kept as text: what type they are is for the reader of the key to
/// say, so that YAML's `no` or `1e3` surprise nobody.
struct YamlNode {
  enum class Kind { null, scalar, sequence, map };

  Kind kind = Kind::null;
  std::string text;     ///< of a scalar
  bool quoted = false;  ///< a scalar in quotes: text even if it looks like a number
  int line = 0;         ///< from 1
  int column = 0;       ///< from 1
  std::string key;      ///< of a map's value
  int key_line = 0;
  int key_column = 0;
  std::vector<YamlNode> items;  ///< of a sequence or a map, in the file's order

  bool is_null() const { return kind == Kind::null; }
  bool is_map() const { return kind == Kind::map; }
  bool is_sequence() const { return kind == Kind::sequence; }
  bool is_scalar() const { return kind == Kind::scalar; }
  /// A map's value, or nullptr.
  const YamlNode* find(std::string_view name) const;
};

/// The largest YAML file that is read, and how deep its values may nest.
inline constexpr std::size_t max_yaml_bytes = std::size_t{4} << 20;
inline constexpr std::size_t max_yaml_depth = 32;

/// The one document of a YAML text; an empty text is a null. Refused with every place: syntax errors,
/// duplicate keys, anchors and aliases, keys that are not scalars, nesting beyond max_yaml_depth, texts
/// beyond max_yaml_bytes, a second document. `name` is what errors call the file, `code` their kind.
Result<YamlNode> parse_yaml(const std::string& text, const std::string& name,
                            ErrorCode code = ErrorCode::config);

}  // namespace ca2
