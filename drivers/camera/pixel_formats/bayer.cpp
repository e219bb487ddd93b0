#include "drivers/camera/pixel_formats/bayer.h"

#include <algorithm>
#include <array>
#include <vector>

#include "core/types/hot_loop.h"
#include "drivers/camera/pixel_formats/luminance.h"

namespace ca2 {
namespace {

/// Where red is in the first two rows and columns; blue is diagonally opposite.
struct Phase {
  int red_x, red_y;
};

Phase phase_of(PixelColour order) {
  switch (order) {
    case PixelColour::bayer_gr:
      return {1, 0};
    case PixelColour::bayer_gb:
      return {0, 1};
    case PixelColour::bayer_bg:
      return {1, 1};
    default:
      return {0, 0};
  }
}

/// Three rows with one mirrored sample at either end: `up`, `mid` and `down` point to the sample at x = 0.
template <class Sample>
class Rows {
 public:
  Rows(const Sample* from, std::size_t stride, int width, int height)
      : from_(from), stride_(stride), width_(static_cast<std::size_t>(width)), height_(height) {
    for (auto& row : rows_) row.resize(width_ + 2);
    fill(1);  // row -1 is row 1
    fill(0);
  }

  /// Goes to the next row.
  void advance(int y) {
    fill(y + 1 < height_ ? y + 1 : height_ - 2);
    up = at(2);
    mid = at(1);
    down = at(0);
  }

  const Sample *up = nullptr, *mid = nullptr, *down = nullptr;

 private:
  void fill(int y) {
    newest_ = (newest_ + 1) % 3;
    std::vector<Sample>& row = rows_[newest_];
    const Sample* line = from_ + stride_ * static_cast<std::size_t>(y);
    std::copy(line, line + width_, row.begin() + 1);
    row.front() = line[1];
    row.back() = line[width_ - 2];
  }
  const Sample* at(std::size_t age) const { return rows_[(newest_ + 3 - age) % 3].data() + 1; }

  const Sample* from_;
  std::size_t stride_, width_;
  int height_;
  std::array<std::vector<Sample>, 3> rows_;
  std::size_t newest_ = 0;
};

/// Luminance is a 3 x 3 filter whose weights depend on which sample it stands on. Shares of 2^16.
struct Filter {
  std::uint32_t center, horizontal, vertical, diagonal;
};

constexpr Filter on_red{4 * red_weight, green_weight, green_weight, blue_weight};
constexpr Filter on_blue{4 * blue_weight, green_weight, green_weight, red_weight};
constexpr Filter on_green_of_red_row{4 * green_weight, 2 * red_weight, 2 * blue_weight, 0};
constexpr Filter on_green_of_blue_row{4 * green_weight, 2 * blue_weight, 2 * red_weight, 0};

/// The largest sum is 2^16 times the largest sample: it fits.
template <class Sample>
inline Sample filtered(const Filter& f, const Sample* up, const Sample* mid, const Sample* down) {
  const std::uint32_t sum = f.center * mid[0] + f.horizontal * (std::uint32_t{mid[-1]} + mid[1]) +
                            f.vertical * (std::uint32_t{up[0]} + down[0]) +
                            f.diagonal * (std::uint32_t{up[-1]} + up[1] + down[-1] + down[1]);
  return static_cast<Sample>((sum + (1u << (weight_bits + 1))) >> (weight_bits + 2));
}

/// Pairs of pixels: the even ones take `even`, the odd ones `odd`.
template <class Sample>
inline void grey_row(const Filter& even, const Filter& odd, const Sample* up, const Sample* mid,
                     const Sample* down, std::size_t width, Sample* to) {
  for (std::size_t x = 0; x + 1 < width; x += 2) {
    to[x] = filtered(even, up + x, mid + x, down + x);
    to[x + 1] = filtered(odd, up + x + 1, mid + x + 1, down + x + 1);
  }
  if (width % 2) to[width - 1] = filtered(even, up + width - 1, mid + width - 1, down + width - 1);
}

// target_clones does not go with templates: one function of each width.
CA2_HOT_LOOP void grey_row8(const Filter& even, const Filter& odd, const std::uint8_t* up,
                            const std::uint8_t* mid, const std::uint8_t* down, std::size_t width,
                            std::uint8_t* to) {
  grey_row(even, odd, up, mid, down, width, to);
}
CA2_HOT_LOOP void grey_row16(const Filter& even, const Filter& odd, const std::uint16_t* up,
                             const std::uint16_t* mid, const std::uint16_t* down, std::size_t width,
                             std::uint16_t* to) {
  grey_row(even, odd, up, mid, down, width, to);
}

void grey_row_of(const Filter& even, const Filter& odd, const Rows<std::uint8_t>& rows, std::size_t width,
                 std::uint8_t* to) {
  grey_row8(even, odd, rows.up, rows.mid, rows.down, width, to);
}
void grey_row_of(const Filter& even, const Filter& odd, const Rows<std::uint16_t>& rows, std::size_t width,
                 std::uint16_t* to) {
  grey_row16(even, odd, rows.up, rows.mid, rows.down, width, to);
}

template <class Sample>
inline Sample mean2(Sample a, Sample b) {
  return static_cast<Sample>((std::uint32_t{a} + b + 1) / 2);
}
template <class Sample>
inline Sample mean4(Sample a, Sample b, Sample c, Sample d) {
  return static_cast<Sample>((std::uint32_t{a} + b + c + d + 2) / 4);
}

}  // namespace

template <class Sample>
void bayer_to_grey(const Sample* from, std::size_t stride, int width, int height, PixelColour order,
                   Sample* to) {
  const Phase red = phase_of(order);
  Rows<Sample> rows(from, stride, width, height);
  for (int y = 0; y < height; ++y, to += width) {
    rows.advance(y);
    const bool red_row = y % 2 == red.red_y;
    const Filter& color = red_row ? on_red : on_blue;
    const Filter& green = red_row ? on_green_of_red_row : on_green_of_blue_row;
    const bool color_first = (red.red_x == 0) == red_row;
    grey_row_of(color_first ? color : green, color_first ? green : color, rows,
                static_cast<std::size_t>(width), to);
  }
}

template <class Sample>
void bayer_to_rgb(const Sample* from, std::size_t stride, int width, int height, PixelColour order,
                  Sample* to) {
  const Phase red = phase_of(order);
  Rows<Sample> rows(from, stride, width, height);
  for (int y = 0; y < height; ++y) {
    rows.advance(y);
    const bool red_row = y % 2 == red.red_y;
    const std::size_t color_x = (red.red_x == 0) == red_row ? 0 : 1;
    // The row's own colour, and the one of the rows above and below.
    const int own = red_row ? 0 : 2, other = 2 - own;
    for (std::size_t x = 0; x < static_cast<std::size_t>(width); ++x, to += 3) {
      const Sample *up = rows.up + x, *mid = rows.mid + x, *down = rows.down + x;
      if (x % 2 == color_x) {
        to[own] = mid[0];
        to[1] = mean4(mid[-1], mid[1], up[0], down[0]);
        to[other] = mean4(up[-1], up[1], down[-1], down[1]);
      } else {
        to[own] = mean2(mid[-1], mid[1]);
        to[1] = mid[0];
        to[other] = mean2(up[0], down[0]);
      }
    }
  }
}

template void bayer_to_grey(const std::uint8_t*, std::size_t, int, int, PixelColour, std::uint8_t*);
template void bayer_to_grey(const std::uint16_t*, std::size_t, int, int, PixelColour, std::uint16_t*);
template void bayer_to_rgb(const std::uint8_t*, std::size_t, int, int, PixelColour, std::uint8_t*);
template void bayer_to_rgb(const std::uint16_t*, std::size_t, int, int, PixelColour, std::uint16_t*);

}  // namespace ca2
