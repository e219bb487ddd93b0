/// @file Little-endian numbers in packets, at any alignment.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>

namespace ca2 {

static_assert(std::endian::native == std::endian::little, "packets are read by copying");

/// The number at `bytes`; all sizeof(T) bytes must exist.
template <class T>
inline T load(const std::uint8_t* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

template <class T>
inline void store(std::uint8_t* bytes, T value) {
  std::memcpy(bytes, &value, sizeof value);
}

/// Numbers of 24 and 40 bits.
inline std::uint64_t load_bytes(const std::uint8_t* bytes, int count) {
  std::uint64_t value = 0;
  std::memcpy(&value, bytes, static_cast<std::size_t>(count));
  return value;
}

inline void store_bytes(std::uint8_t* bytes, std::uint64_t value, int count) {
  std::memcpy(bytes, &value, static_cast<std::size_t>(count));
}

}  // namespace ca2
