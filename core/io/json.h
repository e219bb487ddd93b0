/// @file JSON that may come from anybody.
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string_view>

namespace ca2 {

/// How deep values may nest; as YAML's.
inline constexpr std::size_t max_json_depth = 32;

/// Discarded (`is_discarded()`) where the text is no JSON, or nests too deep: the library reads any depth,
/// but copies, compares and writes by recursion, so that half a megabyte of brackets overflows the stack.
nlohmann::json parse_json(std::string_view text);

}  // namespace ca2
