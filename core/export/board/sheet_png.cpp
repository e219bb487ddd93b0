#include <zlib.h>

#include <algorithm>
#include <cmath>

#include "core/export/board/sheet.h"
#include "core/io/files.h"

namespace ca2 {
namespace {

void append_be(std::string& out, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) out += static_cast<char>(value >> shift & 0xff);
}

/// The chunk that says how large a pixel is, right behind the header.
void insert_resolution(std::string& png, double dots_per_inch) {
  const auto per_metre = static_cast<std::uint32_t>(std::lround(dots_per_inch / 0.0254));
  std::string body = "pHYs";
  append_be(body, per_metre);
  append_be(body, per_metre);
  body += '\1';  // the unit is the metre
  std::string chunk;
  append_be(chunk, static_cast<std::uint32_t>(body.size() - 4));
  chunk += body;
  append_be(chunk, static_cast<std::uint32_t>(crc32(0, reinterpret_cast<const Bytef*>(body.data()),
                                                    static_cast<uInt>(body.size()))));
  constexpr std::size_t signature_and_header = 8 + 25;
  png.insert(signature_and_header, chunk);
}

/// Share of [pixel, pixel + 1] inside [begin, end].
double share(double begin, double end, int pixel) {
  return std::max(0.0, std::min(end, pixel + 1.0) - std::max(begin, static_cast<double>(pixel)));
}

}  // namespace

Result<std::string> sheet_png(const Sheet& sheet, double dots_per_inch) {
  const double scale = dots_per_inch / 0.0254;  // px/m
  const double width = std::round(sheet.paper.width * scale), height = std::round(sheet.paper.height * scale);
  if (!(width >= 1 && height >= 1 && width <= 30000 && height <= 30000)) {
    return fail(ErrorCode::usage, "",
                "the picture would have " + std::to_string(static_cast<long>(width)) + " x " +
                    std::to_string(static_cast<long>(height)) + " pixels, 30000 are the most",
                "take a smaller --dpi, or PDF or SVG");
  }
  Image image{static_cast<int>(width), static_cast<int>(height), 1, 8, {}};
  std::vector<float> ink(static_cast<std::size_t>(width * height), 0.0f);
  for (const InkRectangle& r : sheet.ink) {
    const double x0 = r.x * scale, x1 = (r.x + r.width) * scale, y0 = r.y * scale,
                 y1 = (r.y + r.height) * scale;
    for (int y = std::max(0, static_cast<int>(y0)); y < std::min<double>(image.height, y1); ++y) {
      float* row = ink.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width);
      for (int x = std::max(0, static_cast<int>(x0)); x < std::min<double>(image.width, x1); ++x) {
        row[x] += static_cast<float>(share(y0, y1, y) * share(x0, x1, x));
      }
    }
  }
  image.bytes.reserve(ink.size());
  for (const float share_of_ink : ink) {
    image.bytes.push_back(static_cast<std::uint8_t>(std::lround(255 * (1 - std::min(share_of_ink, 1.0f)))));
  }
  Result<std::string> png = encode_png(image);
  if (png) insert_resolution(*png, dots_per_inch);
  return png;
}

}  // namespace ca2
