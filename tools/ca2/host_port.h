/// @file An address on the command line.
#pragma once

#include <cstdint>
#include <string>

#include "core/types/result.h"

namespace ca2 {

struct HostPort {
  std::string host;
  std::uint16_t port = 0;  ///< 0: none given
};

/// "HOST", "HOST:PORT", "[IPv6]:PORT" or a bare IPv6 address.
Result<HostPort> parse_host_port(const std::string& text);

}  // namespace ca2
