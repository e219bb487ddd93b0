/// @file Little-endian numbers of a packet. The caller has checked that the bytes are there.
#pragma once

#include <cstdint>
#include <span>

namespace ca2 {

/// `count` bytes from `at`, up to 8.
inline std::uint64_t read_le(std::span<const std::uint8_t> bytes, std::size_t at, std::size_t count) {
  std::uint64_t value = 0;
  for (std::size_t i = count; i-- > 0;) value = value << 8 | bytes[at + i];
  return value;
}

}  // namespace ca2
