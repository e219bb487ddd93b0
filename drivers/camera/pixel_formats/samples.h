/// @file Samples of 9 to 16 bits, from however they are packed to 16 bits with the significant ones on top.
#pragma once

#include <cstddef>
#include <cstdint>

#include "drivers/camera/pixel_formats/pixel_format.h"

namespace ca2 {

/// `count` samples of `bits` significant bits each, little endian, moved up. Bits above them are dropped.
void widen_words(const std::uint8_t* from, std::size_t count, int bits, std::uint16_t* to);

/// `count` samples of a packed format.
void unpack_samples(PixelPacking packing, const std::uint8_t* from, std::size_t count, std::uint16_t* to);

}  // namespace ca2
