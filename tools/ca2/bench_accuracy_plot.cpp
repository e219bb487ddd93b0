#include "tools/ca2/bench_accuracy_plot.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "core/types/text.h"

namespace ca2 {
namespace {

constexpr double width = 300, height = 320, left = 44, top = 28, bottom = 46;  // px of one frame
constexpr double least = 0.005, most = 100;                                    // mm

double y_of(double mm) {
  const double share = std::log(std::clamp(mm, least, most) / least) / std::log(most / least);
  return top + (1 - share) * (height - top - bottom);
}

double x_of(double views) {
  return left + std::log(views / 2.5) / std::log(48 / 2.5) * (width - left - 8);
}

struct Line {
  const char* name;
  const char* colour;
  bool dashed;
  double (*value)(const AccuracyCell&);  // m; 0: none
};

double mean_of(const AccuracyCell& cell, const char* method) {
  const auto found = cell.methods.find(method);
  return found == cell.methods.end() ? 0 : found->second.mean_translation();
}

// The mean length of a Gaussian error of three equal components is 0.92 of its root mean square.
constexpr double mean_of_rms = 0.921;

constexpr Line lines[]{
    {"kim", "#888888", false, [](const AccuracyCell& cell) { return mean_of(cell, kim_name); }},
    {"plane_to_plane", "#c0504d", false, [](const AccuracyCell& cell) { return mean_of(cell, planes_name); }},
    {"joint", "#4f81bd", false, [](const AccuracyCell& cell) { return mean_of(cell, joint_name); }},
    {"bound", "#4f81bd", true, [](const AccuracyCell& cell) { return mean_of_rms * cell.bound_translation; }},
    {"joint with edges", "#2e8b57", false,
     [](const AccuracyCell& cell) { return mean_of(cell, edges_name); }},
    {"bound with edges", "#2e8b57", true,
     [](const AccuracyCell& cell) { return mean_of_rms * cell.edge_bound_translation; }},
};

std::string frame(const std::vector<const AccuracyCell*>& cells) {
  std::string svg = formatted("<text x=\"%.0f\" y=\"16\" font-weight=\"bold\">%s</text>\n", left,
                              cells.front()->experiment.c_str());
  for (const double mm : {0.01, 0.1, 1.0, 10.0, 100.0}) {
    svg += formatted("<line x1=\"%.0f\" x2=\"%.0f\" y1=\"%.1f\" y2=\"%.1f\" stroke=\"#dddddd\"/>\n", left,
                     width, y_of(mm), y_of(mm));
    svg +=
        formatted("<text x=\"%.0f\" y=\"%.1f\" text-anchor=\"end\">%g</text>\n", left - 4, y_of(mm) + 4, mm);
  }
  for (const AccuracyCell* cell : cells) {
    // Where numbers of views crowd, the even tens are labelled.
    if (cell->views == 4 || cell->views == 39) continue;
    svg += formatted("<text x=\"%.1f\" y=\"%.0f\" text-anchor=\"middle\">%d</text>\n", x_of(cell->views),
                     height - bottom + 14, cell->views);
  }
  for (const Line& line : lines) {
    std::string points;
    for (const AccuracyCell* cell : cells) {
      const double mm = 1e3 * line.value(*cell);
      if (mm > 0) points += formatted("%.1f,%.1f ", x_of(cell->views), y_of(mm));
    }
    svg += formatted("<polyline points=\"%s\" fill=\"none\" stroke=\"%s\" stroke-width=\"1.6\"%s/>\n",
                     points.c_str(), line.colour, line.dashed ? " stroke-dasharray=\"4 3\"" : "");
  }
  return svg;
}

}  // namespace

std::string accuracy_plot(const std::vector<AccuracyCell>& cells) {
  std::vector<std::vector<const AccuracyCell*>> experiments;
  for (const AccuracyCell& cell : cells) {
    if (experiments.empty() || experiments.back().front()->experiment != cell.experiment)
      experiments.emplace_back();
    experiments.back().push_back(&cell);
  }
  constexpr int per_row = 3;
  const int frames = static_cast<int>(experiments.size());
  const int rows = (frames + per_row - 1) / per_row;
  const double whole_width = width * std::min(per_row, std::max(1, frames)) + 10;
  std::string svg = formatted(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0f\" height=\"%.0f\" font-family=\"sans-serif\" "
      "font-size=\"11\">\n<rect width=\"100%%\" height=\"100%%\" fill=\"white\"/>\n",
      whole_width, height * rows + 30);
  for (int i = 0; i < frames; ++i) {
    svg +=
        formatted("<g transform=\"translate(%.0f %.0f)\">\n", width * (i % per_row), height * (i / per_row));
    svg += frame(experiments[static_cast<std::size_t>(i)]) + "</g>\n";
  }
  double x = left;
  const double y = height * rows + 8;
  for (const Line& line : lines) {
    svg += formatted(
        "<line x1=\"%.0f\" x2=\"%.0f\" y1=\"%.0f\" y2=\"%.0f\" stroke=\"%s\" stroke-width=\"1.6\"%s/>\n", x,
        x + 22, y - 4, y - 4, line.colour, line.dashed ? " stroke-dasharray=\"4 3\"" : "");
    svg += formatted("<text x=\"%.0f\" y=\"%.0f\">%s</text>\n", x + 26, y, line.name);
    x += 130;
  }
  svg += formatted(
      "<text x=\"%.0f\" y=\"%.0f\">mean translation error, mm, over the number of views</text>\n</svg>\n",
      left, y + 16);
  return svg;
}

}  // namespace ca2
