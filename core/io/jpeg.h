/// @file JPEG pictures in memory: what reports embed, and what cameras and recordings give.
#pragma once

#include <string>
#include <string_view>

#include "core/types/image.h"
#include "core/types/result.h"

namespace ca2 {

/// An 8-bit grey or colour picture as a JPEG file, `quality` 1..100.
Result<std::string> encode_jpeg(const Image& image, int quality);

enum class JpegColours { as_stored, grey };

/// A grey or colour JPEG at 8 bits (`grey`: the luma alone, quicker); Motion-JPEG without Huffman tables has
/// the standard ones (ITU-T T.81, annex K.3). Whatever is damaged or cut short is ErrorCode::data: half a
/// picture is none. At most 30000 x 30000 pixels and 512 MiB of them. `name` is what errors call the picture.
Result<Image> decode_jpeg(std::string_view bytes, const std::string& name,
                          JpegColours wanted = JpegColours::as_stored);

}  // namespace ca2
