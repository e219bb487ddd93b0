#include "core/solve/correction_notes.h"

#include <algorithm>
#include <cmath>

#include "core/types/text.h"

namespace ca2 {
namespace {

/// How far the correction moves the corners that camera `c` saw at most, px.
double correction(const Camera& given, const Camera& estimated, const std::vector<ViewSights>& views,
                  std::size_t c) {
  double most = 0;
  for (const ViewSights& view : views) {
    if (!view.cameras[c]) continue;
    for (const Corner& corner : view.cameras[c]->corners) {
      const auto bearing = estimated.unproject(corner.pixel);
      const auto before = bearing ? given.project(*bearing) : std::nullopt;
      if (before) most = std::max(most, (*before - corner.pixel).norm());
    }
  }
  return most;
}

const char* size_word(double stretch) {
  return stretch < 0 ? "smaller" : "larger";
}

}  // namespace

std::vector<std::string> correction_notes(const Rig& rig, const std::vector<ViewSights>& views,
                                          const JointAnswer& answer, const CalibratedPrint& print) {
  std::vector<std::string> notes;
  std::size_t c = 0;
  for (const auto& [name, camera] : rig.cameras) {
    const std::size_t i = c++;
    if (answer.free_intrinsics[i] <= 4) continue;
    notes.push_back(formatted(
        "the corners contradict the distortion given for %s: it was estimated too, which moves them by up to "
        "%.1f px",
        name.c_str(), correction(*camera.intrinsics, answer.state.cameras[i], views, i)));
  }
  if (print.estimated) {
    notes.push_back(
        formatted("the views contradict the size of the print: it is %.2f +- %.2f %% %s than stated "
                  "along x and %.2f +- %.2f %% %s along y; measure it",
                  100 * std::abs(print.stretch.x()), 100 * print.sigma.x(), size_word(print.stretch.x()),
                  100 * std::abs(print.stretch.y()), 100 * print.sigma.y(), size_word(print.stretch.y())));
  }
  if (answer.rims_off) {
    std::string note =
        formatted("the plates' rims lie %.0f mm behind their print", 1e3 * answer.state.rim_depth);
    std::size_t l = 0;
    for (const auto& [name, lidar] : rig.lidars) {
      const double margin = answer.state.dilation[l++].margin;
      note += formatted(", and %s sees them %.0f mm too far %s", name.c_str(), 1e3 * std::abs(margin),
                        margin < 0 ? "in" : "out");
    }
    notes.push_back(note + ": both were estimated (a thick plate, wide beams, an outline that is off)");
  }
  return notes;
}

}  // namespace ca2
