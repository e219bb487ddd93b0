/// @file JPEG pictures in memory: what reports embed.
#pragma once

#include <string>

#include "core/types/image.h"
#include "core/types/result.h"

namespace ca2 {

/// An 8-bit grey or colour picture as a JPEG file, `quality` 1..100.
Result<std::string> encode_jpeg(const Image& image, int quality);

}  // namespace ca2
