#include <png.h>
#include <zlib.h>

#include <bit>
#include <csetjmp>
#include <cstring>

#include "core/io/files.h"

namespace ca2 {
namespace {

constexpr std::size_t piece_size = 1 << 18;  // bytes

struct Writer {
  const PieceSink& sink;
  std::string piece;
  bool wanted = true;
  std::jmp_buf failed;
  char reason[128] = "";
};

[[noreturn]] void on_error(png_structp png, png_const_charp message) {
  auto* writer = static_cast<Writer*>(png_get_error_ptr(png));
  std::strncpy(writer->reason, message, sizeof writer->reason - 1);
  std::longjmp(writer->failed, 1);
}

void on_warning(png_structp, png_const_charp) {}

void on_write(png_structp png, png_bytep from, png_size_t size) {
  auto& writer = *static_cast<Writer*>(png_get_io_ptr(png));
  if (!writer.wanted) return;
  writer.piece.append(reinterpret_cast<const char*>(from), size);
  if (writer.piece.size() < piece_size) return;
  writer.wanted = writer.sink(writer.piece);
  writer.piece.clear();
}

void on_flush(png_structp) {}

/// Only trivial objects here: libpng's errors come back by longjmp.
bool encode(png_structp png, png_infop info, Writer& writer, const Image& image, PngData data) {
  if (setjmp(writer.failed) != 0) return false;
  png_set_write_fn(png, &writer, on_write, on_flush);
  png_set_IHDR(png, info, static_cast<png_uint_32>(image.width), static_cast<png_uint_32>(image.height),
               image.bits, image.channels == 3 ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  if (data == PngData::stored) {
    png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_NONE);
    png_set_compression_level(png, 0);
    png_set_compression_buffer_size(png, 1 << 16);
  } else {
    // Sensor noise has no repeats worth searching for: the entropy coder does all the work that pays.
    png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_UP);
    png_set_compression_level(png, 1);
    png_set_compression_strategy(png, Z_RLE);
  }
  png_write_info(png, info);
  if (image.bits == 16 && std::endian::native == std::endian::little) png_set_swap(png);
  const std::size_t row_bytes = static_cast<std::size_t>(image.width) * image.bytes_per_pixel();
  for (std::size_t y = 0; y < static_cast<std::size_t>(image.height); ++y) {
    png_write_row(png, image.bytes.data() + y * row_bytes);
  }
  png_write_end(png, info);
  return true;
}

}  // namespace

Result<void> encode_png(const Image& image, PngData data, const PieceSink& sink) {
  const bool sound = image.width > 0 && image.height > 0 && (image.channels == 1 || image.channels == 3) &&
                     (image.bits == 8 || image.bits == 16) &&
                     image.bytes.size() == static_cast<std::size_t>(image.width) *
                                               static_cast<std::size_t>(image.height) *
                                               image.bytes_per_pixel();
  if (!sound) {
    return fail(ErrorCode::internal, "",
                "a picture whose size, channels, bits and bytes do not fit together");
  }
  Writer writer{sink, {}, true, {}, {}};
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &writer, on_error, on_warning);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  const bool done = info && encode(png, info, writer, image, data);
  png_destroy_write_struct(&png, &info);
  if (!done) return fail(ErrorCode::internal, "", std::string("PNG: ") + writer.reason);
  if (writer.wanted && !writer.piece.empty()) sink(writer.piece);
  return {};
}

Result<std::string> encode_png(const Image& image, PngData data) {
  std::string bytes;
  bytes.reserve(data == PngData::stored ? image.bytes.size() + image.bytes.size() / 512 + 4096
                                        : image.bytes.size() / 2);
  const auto encoded = encode_png(image, data, [&](std::string_view piece) {
    bytes += piece;
    return true;
  });
  return encoded ? Result<std::string>(std::move(bytes)) : fail(encoded.error());
}

Result<void> write_png(const std::filesystem::path& file, const Image& image) {
  const Result<std::string> bytes = encode_png(image);
  if (!bytes) return fail(bytes.error());
  return write_atomically(file, *bytes);
}

}  // namespace ca2
