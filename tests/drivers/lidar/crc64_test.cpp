// The checksum against its definition, at every length at which another of its loops begins or ends.
#include "drivers/lidar/crc64.h"

#include <gtest/gtest.h>

#include <random>
#include <string_view>
#include <vector>

namespace ca2 {
namespace {

std::uint64_t bit_by_bit(std::span<const std::uint8_t> bytes) {
  std::uint64_t crc = ~std::uint64_t{0};
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1) != 0 ? 0xC96C5795D7870F42u : 0);
  }
  return ~crc;
}

TEST(Crc64, IsTheCheckValueOfTheCatalogue) {
  constexpr std::string_view digits = "123456789";
  const std::vector<std::uint8_t> bytes(digits.begin(), digits.end());
  EXPECT_EQ(crc64(bytes), 0x995DC9BBDF1939FAu);  // CRC-64/XZ
}

TEST(Crc64, EveryLengthIsTheDefinition) {
  std::mt19937_64 random(3);
  std::vector<std::uint8_t> bytes(25'000);
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
  const std::span<const std::uint8_t> all(bytes);
  for (std::size_t size = 0; size < 700; ++size) {
    ASSERT_EQ(crc64(all.subspan(size % 16, size)), bit_by_bit(all.subspan(size % 16, size))) << size;
  }
  EXPECT_EQ(crc64(all), bit_by_bit(all));
}

}  // namespace
}  // namespace ca2
