/// @file CRC-64/XZ: polynomial of ECMA-182, reflected; what Ouster puts at the end of its packets.
#pragma once

#include <cstdint>
#include <span>

namespace ca2 {

std::uint64_t crc64(std::span<const std::uint8_t> bytes);

}  // namespace ca2
