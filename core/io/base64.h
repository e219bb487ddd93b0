/// @file Bytes as text (RFC 4648, section 4): pictures inside HTML and JSON.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace ca2 {

std::string to_base64(std::string_view bytes);
/// Nothing where the text is not base64 with its padding.
std::optional<std::string> from_base64(std::string_view text);

}  // namespace ca2
