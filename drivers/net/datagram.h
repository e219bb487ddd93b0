/// @file A UDP datagram as a socket received it or a capture file kept it.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace ca2 {

/// Borrowed: valid until the source is asked for the next one.
struct Datagram {
  std::int64_t time = 0;            ///< ns UTC, when the host received it (kernel or capture time stamp)
  std::string_view source_address;  ///< textual IPv4 or IPv6
  std::uint16_t source_port = 0;
  std::uint16_t destination_port = 0;
  std::span<const std::uint8_t> payload;
  bool truncated = false;  ///< longer than what was kept
};

}  // namespace ca2
