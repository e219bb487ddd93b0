#include <png.h>

#include <bit>
#include <csetjmp>
#include <cstring>

#include "core/io/files.h"

namespace ca2 {
namespace {

constexpr png_uint_32 max_side = 30000;  // px
constexpr std::size_t max_pixel_bytes = std::size_t{512} << 20;
constexpr std::size_t max_file_bytes = std::size_t{1} << 30;
/// Deflate cannot expand more than this: a header that promises more is a bomb or a truncated file, and is
/// found out before memory is taken for it.
constexpr std::size_t max_expansion = 1032;

struct Reader {
  std::string_view bytes;
  std::size_t position = 0;
  std::jmp_buf failed;
  char reason[128] = "";
};

[[noreturn]] void on_error(png_structp png, png_const_charp message) {
  auto* reader = static_cast<Reader*>(png_get_error_ptr(png));
  std::strncpy(reader->reason, message, sizeof reader->reason - 1);
  std::longjmp(reader->failed, 1);
}

/// What libpng only warns of (a colour profile it dislikes) has no bearing on the pixels.
void on_warning(png_structp, png_const_charp) {}

void on_read(png_structp png, png_bytep to, png_size_t size) {
  auto* reader = static_cast<Reader*>(png_get_io_ptr(png));
  if (size > reader->bytes.size() - reader->position) png_error(png, "the file is cut short");
  std::memcpy(to, reader->bytes.data() + reader->position, size);
  reader->position += size;
}

bool grey_palette(png_structp png, png_infop info) {
  png_colorp palette = nullptr;
  int count = 0;
  if (!png_get_PLTE(png, info, &palette, &count)) return false;
  for (int i = 0; i < count; ++i) {
    if (palette[i].red != palette[i].green || palette[i].red != palette[i].blue) return false;
  }
  return true;
}

/// Reads everything into `image`. libpng's errors come back by longjmp, so this frame and those below have
/// only trivial objects; what must survive lives in the caller's.
bool decode(png_structp png, png_infop info, Reader& reader, Image& image, std::vector<png_bytep>& rows,
            bool& grey) {
  if (setjmp(reader.failed) != 0) return false;
  png_set_user_limits(png, max_side, max_side);
  png_set_chunk_malloc_max(png, png_alloc_size_t{16} << 20);
  png_set_read_fn(png, &reader, on_read);
  png_read_info(png, info);
  const int type = png_get_color_type(png, info);
  if (type == PNG_COLOR_TYPE_PALETTE) {
    grey = grey_palette(png, info);
    png_set_palette_to_rgb(png);
  } else if (png_get_bit_depth(png, info) < 8) {
    png_set_expand_gray_1_2_4_to_8(png);
  }
  png_set_strip_alpha(png);
  if (std::endian::native == std::endian::little) png_set_swap(png);
  png_set_interlace_handling(png);
  png_read_update_info(png, info);

  image.width = static_cast<int>(png_get_image_width(png, info));
  image.height = static_cast<int>(png_get_image_height(png, info));
  image.channels = png_get_channels(png, info);
  image.bits = png_get_bit_depth(png, info);
  const std::size_t row_bytes = static_cast<std::size_t>(image.width) * image.bytes_per_pixel();
  const std::size_t size = row_bytes * static_cast<std::size_t>(image.height);
  if ((image.channels != 1 && image.channels != 3) || row_bytes != png_get_rowbytes(png, info)) {
    png_error(png, "a pixel format that is neither grey nor colour");
  }
  if (size > max_pixel_bytes) png_error(png, "more than 512 MiB of pixels");
  // The stored row may be narrower than ours: 1 bit of grey becomes 8, an index becomes three bytes.
  if (size / 24 / max_expansion > reader.bytes.size()) png_error(png, "the file is cut short");
  image.bytes.resize(size);
  rows.resize(static_cast<std::size_t>(image.height));
  for (std::size_t y = 0; y < rows.size(); ++y) rows[y] = image.bytes.data() + y * row_bytes;
  png_read_image(png, rows.data());
  png_read_end(png, nullptr);
  return true;
}

void keep_first_channel(Image& image) {
  const std::size_t count = image.bytes.size() / 3;
  for (std::size_t i = 0; i < count; ++i) image.bytes[i] = image.bytes[3 * i];
  image.bytes.resize(count);
  image.channels = 1;
}

}  // namespace

Result<Image> decode_png(std::string_view bytes, const std::string& name) {
  if (bytes.size() < 8 || png_sig_cmp(reinterpret_cast<png_const_bytep>(bytes.data()), 0, 8) != 0) {
    return fail(ErrorCode::data, name, bytes.empty() ? "is empty" : "is not a PNG picture");
  }
  Reader reader{bytes, 0, {}, {}};
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &reader, on_error, on_warning);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  Image image;
  std::vector<png_bytep> rows;
  bool grey = false;
  const bool done = info && decode(png, info, reader, image, rows, grey);
  png_destroy_read_struct(&png, &info, nullptr);
  if (!done) {
    return fail(ErrorCode::data, name, std::string("is a damaged PNG picture: ") + reader.reason,
                "copy or record the file again");
  }
  if (grey) keep_first_channel(image);
  return image;
}

Result<Image> read_png(const std::filesystem::path& file) {
  const Result<std::string> bytes = read_text(file, max_file_bytes);
  if (!bytes) return fail(bytes.error());
  return decode_png(*bytes, file.string());
}

}  // namespace ca2
