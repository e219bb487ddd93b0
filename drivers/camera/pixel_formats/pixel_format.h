/// @file How cameras lay out their pixels, and what becomes of them: the picture, at full size and depth.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/types/image.h"
#include "core/types/result.h"

namespace ca2 {

enum class PixelPacking {
  bytes,   ///< 8 bits
  words,   ///< 16 bits little endian, the significant ones at the low end
  pfnc10,  ///< 4 samples in 5 bytes, a stream of bits from the low end (PFNC "10p")
  pfnc12,  ///< 2 samples in 3 bytes, likewise ("12p")
  gige10,  ///< 2 samples in 3 bytes: high bits A, low bits of both, high bits B (GigE Vision "10Packed")
  gige12,  ///< likewise ("12Packed")
  jpeg,
};

/// bayer_xy: the first two samples of the first row.
enum class PixelColour { mono, bayer_gr, bayer_rg, bayer_gb, bayer_bg, rgb, bgr, yuyv, uyvy, nv12, ycc };

struct PixelFormat {
  std::string_view name;
  std::uint32_t pfnc = 0;    ///< GenICam's code; 0: none
  std::uint32_t fourcc = 0;  ///< V4L2's code; 0: none
  PixelPacking packing = PixelPacking::bytes;
  int bits = 8;  ///< significant ones per sample
  PixelColour colour = PixelColour::mono;

  bool bayer() const { return colour >= PixelColour::bayer_gr && colour <= PixelColour::bayer_bg; }
  /// Bytes of a picture without padding; 0 for JPEG, whose size varies.
  std::size_t tight_size(int width, int height) const;
};

/// The formats of pixel_formats.def, in its order.
std::span<const PixelFormat> pixel_formats();
/// nullptr when there is none.
const PixelFormat* find_pixel_format(std::string_view name);
const PixelFormat* pixel_format_of_pfnc(std::uint32_t code);
const PixelFormat* pixel_format_of_fourcc(std::uint32_t code);
/// "YUYV" of V4L2's code.
std::string fourcc_text(std::uint32_t code);

/// A picture as it came from the camera; a view.
struct RawPicture {
  const PixelFormat* format = nullptr;
  int width = 0, height = 0;
  std::size_t stride = 0;  ///< bytes from row to row; 0: without padding
  std::span<const std::uint8_t> data;
  int bits = 0;             ///< significant ones of a `words` format whose camera uses fewer; 0: the format's
  bool full_range = false;  ///< YUV: 0 to 255 rather than 16 to 235 (luma) and 240 (chroma)
  /// Memory that the picture takes for its bytes, lest it asks the system for new; nullptr: none.
  std::vector<std::uint8_t>* memory = nullptr;
};

enum class PictureKind {
  grey,    ///< luminance: of colours by BT.601's weights; the Y of YUV as it is, the range too
  colour,  ///< red, green, blue where the format has colours, else grey
};

/// The picture, 8 bits per channel or 16 (samples of 9 to 16 bits are moved to the high end: times a power of
/// two). Nothing is scaled, resampled or compressed; colours that a Bayer sensor did not sample are
/// interpolated linearly from the neighbours. ErrorCode::data where the bytes do not fit the format.
Result<Image> to_image(const RawPicture& raw, PictureKind kind);

}  // namespace ca2
