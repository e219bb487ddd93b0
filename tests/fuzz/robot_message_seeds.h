/// @file Messages of robots' logs, byte by byte (docs/import.md).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace ca2::fuzz {

inline std::string big_endian(std::uint64_t value, int bytes) {
  std::string out;
  for (int shift = 8 * (bytes - 1); shift >= 0; shift -= 8) out += static_cast<char>(value >> shift);
  return out;
}

/// A length that counts the zero at the end.
inline std::string wire_text(const std::string& text) {
  return big_endian(text.size() + 1, 4) + text + '\0';
}

inline std::vector<std::string> robot_message_seeds() {
  const std::string stamp = big_endian(1'700'000'000'000'000, 8), head = big_endian(7, 4) + wire_text("top");
  const auto picture = [&](std::uint64_t format, int stride, std::size_t bytes) {
    return big_endian(0x14739ffe13d5f5f0, 8) + stamp + big_endian(4, 4) + big_endian(2, 4) +
           big_endian(static_cast<std::uint64_t>(stride), 4) + big_endian(format, 4) + big_endian(bytes, 4) +
           std::string(bytes, 'p') + big_endian(0, 4);
  };
  const std::string points = big_endian(2, 4) + std::string(24, '\x40'), two = big_endian(2, 4);
  const std::string channels = two + wire_text("intensity") + wire_text("ring") + std::string(16, '\x41');
  const auto field = [](const char* name, std::uint64_t offset, char type) {
    return wire_text(name) + big_endian(offset, 4) + type + big_endian(1, 4);
  };
  return {picture(1497715271, 4, 8),
          picture(859981650, 12, 24),
          picture(825770306, 6, 12),
          picture(1448695129, 8, 16),
          picture(842094158, 4, 12),
          picture(1196444237, 0, 20),
          picture(909199180, 10, 20),
          big_endian(0x0d89dc76eb295069, 8) + stamp + head + points + channels,
          big_endian(0x28885940907521d1, 8) + stamp + head + points + channels,
          big_endian(0x0bcd5ce4bf5a1b4a, 8) + stamp + head + big_endian(1, 4) + big_endian(2, 4) +
              big_endian(5, 4) + field("x", 0, 7) + field("y", 4, 7) + field("z", 8, 8) + field("i", 16, 2) +
              field("ring", 17, 3) + '\0' + big_endian(20, 4) + big_endian(40, 4) + big_endian(40, 4) +
              std::string(40, '\x40') + '\1'};
}

}  // namespace ca2::fuzz
