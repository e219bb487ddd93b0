#include "core/export/board/sheet.h"
#include "core/types/text.h"

namespace ca2 {
namespace {

constexpr double point = 0.0254 / 72;  // m, PDF's unit

}  // namespace

std::string sheet_svg(const Sheet& sheet) {
  const double w = 1e3 * sheet.paper.width, h = 1e3 * sheet.paper.height;
  std::string out = formatted(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.10gmm\" height=\"%.10gmm\" viewBox=\"0 0 %.10g "
      "%.10g\">\n"
      "<rect width=\"100%%\" height=\"100%%\" fill=\"white\"/>\n<path fill=\"black\" d=\"\n",
      w, h, w, h);
  // One path: neighbours would otherwise show a hairline between them.
  for (const InkRectangle& r : sheet.ink) {
    out += formatted("M%.10g %.10gh%.10gv%.10gh%.10gz\n", 1e3 * r.x, 1e3 * r.y, 1e3 * r.width, 1e3 * r.height,
                     -1e3 * r.width);
  }
  return out + "\"/>\n</svg>\n";
}

std::string sheet_pdf(const Sheet& sheet) {
  std::string drawing;
  // One path and one fill, as in SVG. PDF's y goes up from the bottom.
  for (const InkRectangle& r : sheet.ink) {
    drawing += formatted("%.8f %.8f %.8f %.8f re\n", r.x / point,
                         (sheet.paper.height - r.y - r.height) / point, r.width / point, r.height / point);
  }
  drawing += "f\n";
  const std::string objects[] = {
      // No scaling: what viewers' print dialogues take as the default.
      "<< /Type /Catalog /Pages 2 0 R /ViewerPreferences << /PrintScaling /None >> >>",
      "<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
      formatted("<< /Type /Page /Parent 2 0 R /MediaBox [0 0 %.8f %.8f] /Resources << >> /Contents 4 0 R >>",
                sheet.paper.width / point, sheet.paper.height / point),
      "<< /Length " + std::to_string(drawing.size()) + " >>\nstream\n" + drawing + "endstream"};
  std::string out = "%PDF-1.6\n";
  std::string table;
  int number = 0;
  for (const std::string& object : objects) {
    table += formatted("%010zu 00000 n \n", out.size());
    out += std::to_string(++number) + " 0 obj\n" + object + "\nendobj\n";
  }
  const std::size_t table_at = out.size();
  out += "xref\n0 " + std::to_string(number + 1) + "\n0000000000 65535 f \n" + table;
  out += "trailer\n<< /Size " + std::to_string(number + 1) + " /Root 1 0 R >>\nstartxref\n" +
         std::to_string(table_at) + "\n%%EOF\n";
  return out;
}

}  // namespace ca2
