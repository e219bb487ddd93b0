#include "tools/ca2/picture_text.h"

#include <chafa.h>

#include <memory>

namespace ca2 {
namespace {

template <class Type, void (*unref)(Type*)>
struct Unref {
  void operator()(Type* object) const { unref(object); }
};
template <class Type, void (*unref)(Type*)>
using Owned = std::unique_ptr<Type, Unref<Type, unref>>;

Image to_colour(const Image& image) {
  if (image.channels == 3) return image;
  Image colour = image;
  colour.channels = 3;
  colour.bytes.clear();
  for (const std::uint8_t grey : image.bytes) colour.bytes.insert(colour.bytes.end(), 3, grey);
  return colour;
}

}  // namespace

std::vector<std::string> picture_text(const Image& image, int columns, int rows, bool true_colour) {
  if (image.empty() || image.bits != 8 || columns < 2 || rows < 1) return {};
  const Image colour = to_colour(image);
  gint width = columns, height = rows;
  constexpr gfloat cell_aspect = 0.5f;  // a character is twice as high as wide
  chafa_calc_canvas_geometry(colour.width, colour.height, &width, &height, cell_aspect, TRUE, FALSE);

  const Owned<ChafaSymbolMap, chafa_symbol_map_unref> symbols(chafa_symbol_map_new());
  chafa_symbol_map_add_by_tags(symbols.get(), CHAFA_SYMBOL_TAG_VHALF);
  const Owned<ChafaCanvasConfig, chafa_canvas_config_unref> config(chafa_canvas_config_new());
  chafa_canvas_config_set_geometry(config.get(), width, height);
  chafa_canvas_config_set_symbol_map(config.get(), symbols.get());
  chafa_canvas_config_set_canvas_mode(
      config.get(), true_colour ? CHAFA_CANVAS_MODE_TRUECOLOR : CHAFA_CANVAS_MODE_INDEXED_240);
  const Owned<ChafaCanvas, chafa_canvas_unref> canvas(chafa_canvas_new(config.get()));
  chafa_canvas_draw_all_pixels(canvas.get(), CHAFA_PIXEL_RGB8, colour.bytes.data(), colour.width,
                               colour.height, 3 * colour.width);
  GString* text = chafa_canvas_print(canvas.get(), nullptr);
  std::vector<std::string> lines(1);
  for (gsize i = 0; i < text->len; ++i) {
    if (text->str[i] == '\n') {
      lines.emplace_back();
    } else {
      lines.back() += text->str[i];
    }
  }
  g_string_free(text, TRUE);
  return lines;
}

}  // namespace ca2
