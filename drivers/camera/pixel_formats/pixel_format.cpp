#include "drivers/camera/pixel_formats/pixel_format.h"

namespace ca2 {
namespace {

constexpr std::uint32_t fourcc_of(std::string_view text) {
  std::uint32_t code = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    code |= static_cast<std::uint32_t>(static_cast<unsigned char>(text[i])) << (8 * i);
  }
  return code;
}

constexpr PixelFormat formats[] = {
#define CA2_PIXEL_FORMAT(name, pfnc, fourcc, packing, bits, colour) \
  {#name, pfnc, fourcc_of(fourcc), PixelPacking::packing, bits, PixelColour::colour},
#include "drivers/camera/pixel_formats/pixel_formats.def"
#undef CA2_PIXEL_FORMAT
};

template <class Match>
const PixelFormat* find_format(Match match) {
  for (const PixelFormat& format : formats) {
    if (match(format)) return &format;
  }
  return nullptr;
}

}  // namespace

std::span<const PixelFormat> pixel_formats() {
  return formats;
}

const PixelFormat* find_pixel_format(std::string_view name) {
  return find_format([&](const PixelFormat& format) { return format.name == name; });
}

const PixelFormat* pixel_format_of_pfnc(std::uint32_t code) {
  return find_format([&](const PixelFormat& format) { return code != 0 && format.pfnc == code; });
}

const PixelFormat* pixel_format_of_fourcc(std::uint32_t code) {
  return find_format([&](const PixelFormat& format) { return code != 0 && format.fourcc == code; });
}

std::string fourcc_text(std::uint32_t code) {
  std::string text;
  for (int i = 0; i < 4; ++i) {
    const char c = static_cast<char>((code >> (8 * i)) & 0x7f);
    text += c < ' ' ? '?' : c;
  }
  return text;
}

std::size_t PixelFormat::tight_size(int width, int height) const {
  const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  switch (packing) {
    case PixelPacking::words:
      return 2 * pixels;
    case PixelPacking::pfnc10:
      return (10 * pixels + 7) / 8;
    case PixelPacking::pfnc12:
    case PixelPacking::gige10:
    case PixelPacking::gige12:
      return (12 * pixels + 7) / 8;
    case PixelPacking::jpeg:
      return 0;
    case PixelPacking::bytes:
      break;
  }
  switch (colour) {
    case PixelColour::rgb:
    case PixelColour::bgr:
      return 3 * pixels;
    case PixelColour::yuyv:
    case PixelColour::uyvy:
      return 2 * pixels;
    case PixelColour::nv12:
      return pixels +
             2 * (static_cast<std::size_t>(width + 1) / 2) * (static_cast<std::size_t>(height + 1) / 2);
    default:
      return pixels;
  }
}

}  // namespace ca2
