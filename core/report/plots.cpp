#include "core/report/plots.h"

#include <algorithm>
#include <cmath>

#include "core/report/html.h"
#include "core/types/text.h"

namespace ca2 {
namespace {

constexpr double width = 420, height = 240, left = 46, bottom = 34, top = 10, right = 10;  // CSS px

std::string open_svg(double w, double h) {
  return formatted("<svg viewBox=\"0 0 %.6g %.6g\" width=\"%.6g\" height=\"%.6g\" role=img>", w, h, w, h);
}

std::string text(double x, double y, const char* anchor, const std::string& words) {
  return formatted("<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">", x, y, anchor) + escaped(words) +
         "</text>";
}

/// A round number not below the value: 1, 2 or 5 times a power of ten.
double round_up(double value) {
  if (!(value > 0)) return 1;
  const double power = std::pow(10, std::floor(std::log10(value)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (value <= step * power * (1 + 1e-12)) return step * power;
  }
  return 10 * power;
}

/// Both axes with their ends' numbers and names.
std::string axes(double x0, double x1, double y1, const std::string& x, const std::string& y) {
  std::string out =
      formatted("<path class=axis d=\"M%.1f %.1fV%.1fH%.1f\"/>", left, top, height - bottom, width - right);
  out += text(left, height - bottom + 15, "middle", formatted("%.4g", x0));
  out += text(width - right, height - bottom + 15, "end", formatted("%.4g", x1));
  out += text((left + width) / 2, height - 4, "middle", x);
  out += text(left - 5, height - bottom, "end", "0") + text(left - 5, top + 9, "end", formatted("%.4g", y1));
  return out + formatted("<g transform=\"translate(12 %.1f) rotate(-90)\">", (top + height - bottom) / 2) +
         text(0, 0, "middle", y) + "</g>";
}

}  // namespace

std::string group_colour(int group) {
  // The golden angle: neighbours in number are far apart in hue.
  return formatted("hsl(%d 70%% 50%%)", static_cast<int>(std::fmod(group * 137.508, 360)));
}

std::string histogram(std::vector<double> values, const std::string& unit) {
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  if (values.size() < 2) return {};
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) {
    return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
  };
  const double end = round_up(std::max({std::abs(at(0.01)), std::abs(at(0.99)), 1e-12}));
  constexpr int bars = 41;
  std::vector<int> counts(bars);
  for (const double value : values) {
    const double share = std::clamp((value + end) / (2 * end), 0.0, 1.0);
    ++counts[static_cast<std::size_t>(std::min(bars - 1.0, share * bars))];
  }
  const int most = *std::max_element(counts.begin(), counts.end());
  std::string out = open_svg(width, height) + axes(-end, end, most, unit, "count");
  const double step = (width - left - right) / bars, scale = (height - top - bottom) / most;
  for (int i = 0; i < bars; ++i) {
    const double h = counts[static_cast<std::size_t>(i)] * scale;
    out += formatted("<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"var(--bar)\"/>",
                     left + i * step, height - bottom - h, step - 0.6, h);
  }
  return out + "</svg>\n";
}

std::string line_plot(const std::vector<Series>& series, const std::string& x, const std::string& y) {
  double x0 = 1e300, x1 = -1e300, y1 = 0;
  for (const Series& s : series) {
    for (const Eigen::Vector2d& p : s.points) {
      x0 = std::min(x0, p.x());
      x1 = std::max(x1, p.x());
      y1 = std::max(y1, p.y());
    }
  }
  if (!(x1 > x0)) return {};
  y1 = round_up(y1);
  std::string out = open_svg(width, height) + axes(x0, x1, y1, x, y);
  for (std::size_t i = 0; i < series.size(); ++i) {
    const std::string colour = group_colour(static_cast<int>(i) + 1);
    out += "<polyline fill=none stroke-width=2 stroke=\"" + colour + "\" points=\"";
    std::string marks;
    for (const Eigen::Vector2d& p : series[i].points) {
      const double px = left + (p.x() - x0) / (x1 - x0) * (width - left - right);
      const double py = height - bottom - p.y() / y1 * (height - top - bottom);
      out += formatted("%.1f,%.1f ", px, py);
      marks += formatted("<circle cx=\"%.1f\" cy=\"%.1f\" r=3 fill=\"", px, py) + colour + "\"/>";
    }
    out += "\"/>" + marks + "<g style=\"color:" + colour + "\">" +
           text(width - right, top + 12 + 16 * static_cast<double>(i), "end", series[i].name) + "</g>";
  }
  return out + "</svg>\n";
}

std::string dot_plot(const std::vector<Dot>& dots, double frame_width, double frame_height) {
  const double w = 420, h = w * frame_height / frame_width;
  std::string out =
      open_svg(w + 2, h + 2) + formatted("<rect class=axis x=1 y=1 width=\"%.1f\" height=\"%.1f\"/>", w, h);
  for (const Dot& dot : dots) {
    out += formatted("<circle cx=\"%.1f\" cy=\"%.1f\" r=1.8 fill=\"", 1 + dot.x / frame_width * w,
                     1 + dot.y / frame_height * h) +
           group_colour(dot.group) + "\"/>";
  }
  return out + "</svg>\n";
}

std::string direction_plot(const std::vector<Eigen::Vector3d>& directions) {
  constexpr double r = 110, c = r + 6;
  std::string out = open_svg(2 * c, 2 * c);
  // Rings at 30, 60 and 90 degrees from the axis.
  for (const double degrees : {30.0, 60.0, 90.0}) {
    out += formatted("<circle class=axis cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\"/>", c, c, r * degrees / 90);
  }
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const Eigen::Vector3d d = directions[i].normalized();
    const double angle = std::acos(std::clamp(-d.z(), -1.0, 1.0)), across = std::hypot(d.x(), d.y());
    const double scale = across > 1e-12 ? r * angle / (M_PI / 2) / across : 0;
    out += formatted("<circle cx=\"%.1f\" cy=\"%.1f\" r=4 fill=\"", c + d.x() * scale, c + d.y() * scale) +
           group_colour(static_cast<int>(i)) + "\"/>";
  }
  return out + "</svg>\n";
}

}  // namespace ca2
