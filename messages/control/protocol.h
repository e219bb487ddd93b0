/// @file The control socket's protocol: JSON objects, one a line (messages/README.md).
#pragma once

#include <cstddef>

namespace ca2::control {

/// Rises when an older client or daemon could misunderstand. History: 1, the first.
inline constexpr int version = 1;
inline constexpr const char* default_socket = "/run/ca2/control.sock";

/// The longest line a client may send, and the longest the daemon sends, without the line's end. Bytes.
inline constexpr std::size_t max_request = std::size_t{64} << 10;
inline constexpr std::size_t max_reply = std::size_t{8} << 20;

}  // namespace ca2::control
