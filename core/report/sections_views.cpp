/// Pictures, plots, the list of views, and where it all comes from.
#include <algorithm>
#include <cmath>
#include <set>

#include "core/report/html.h"
#include "core/report/plots.h"
#include "core/report/sections.h"
#include "core/types/text.h"

namespace ca2 {
namespace {

std::string figure(const std::string& svg, const std::string& caption) {
  return svg.empty() ? std::string()
                     : "<figure>" + svg + "<figcaption>" + escaped(caption) + "</figcaption></figure>\n";
}

std::string residual_plots(const Evidence& evidence) {
  std::map<std::string, std::vector<double>> pixels, ranges;
  for (const ViewEvidence& view : evidence.views) {
    for (const auto& [camera, errors] : view.corners) {
      for (const CornerError& e : errors) {
        pixels[camera].push_back(e.error.x());
        pixels[camera].push_back(e.error.y());
      }
    }
    for (const auto& [pair, errors] : view.points) {
      for (const BoardPointError& e : errors)
        ranges[pair.second + " on the board as " + pair.first + " sees it"].push_back(1e3 * e.error);
    }
  }
  std::string out;
  for (const auto& [name, values] : pixels)
    out += figure(histogram(values, "px"), name + ": errors of corners, x and y");
  for (const auto& [name, values] : ranges)
    out += figure(histogram(values, "mm"), name + ": errors of ranges");
  return out;
}

std::string settling_plots(const Evidence& evidence) {
  std::string out;
  for (const auto& [pair, steps] : evidence.settling) {
    Series change_t{"change to the answer of all", {}}, sigma_t{"sigma", {}}, change_r = change_t,
                                                                              sigma_r = sigma_t;
    for (const SettlingStep& step : steps) {
      change_t.points.emplace_back(step.views, 1e3 * step.change_translation);
      sigma_t.points.emplace_back(step.views, 1e3 * step.sigma_translation);
      change_r.points.emplace_back(step.views, 1e3 * step.change_rotation);
      sigma_r.points.emplace_back(step.views, 1e3 * step.sigma_rotation);
    }
    out += figure(line_plot({change_t, sigma_t}, "views", "mm"),
                  pair + ": translation from the first views alone");
    out += figure(line_plot({change_r, sigma_r}, "views", "mrad"),
                  pair + ": rotation from the first views alone");
  }
  return out;
}

std::string coverage_plots(const Evidence& evidence, const Calibration& calibration) {
  std::string out;
  for (const auto& [name, calibrated] : calibration.cameras) {
    if (calibrated.camera.width <= 0) continue;
    std::vector<Dot> dots;
    std::vector<Eigen::Vector3d> normals;
    for (std::size_t i = 0; i < evidence.views.size(); ++i) {
      const auto corners = evidence.views[i].corners.find(name);
      if (corners == evidence.views[i].corners.end()) continue;
      for (const CornerError& e : corners->second)
        dots.push_back({e.pixel.x(), e.pixel.y(), static_cast<int>(i)});
      normals.push_back(-evidence.views[i].T_camera_board.at(name).R.col(2));
    }
    out += figure(dot_plot(dots, calibrated.camera.width, calibrated.camera.height),
                  name + ": where the corners were");
    out += figure(direction_plot(normals),
                  name + ": the boards' normals; rings at 30, 60 and 90 degrees from facing the camera");
  }
  return out;
}

std::string stereo(const Evidence& evidence) {
  if (evidence.stereo.empty()) return {};
  std::string out =
      "<h3>Cameras against each other</h3><p>Corners of one camera, placed by its own picture, projected "
      "into the other. It "
      "checks the cameras; an error common to both, or of the LiDAR, does not show here.</p>\n<div "
      "class=scroll><table>"
      "<tr><th>from</th><th>into</th><th>views</th><th>rms, px</th><th>mean offset of the board, "
      "mm</th></tr>\n";
  for (const StereoEvidence& pair : evidence.stereo) {
    out += formatted("<tr><td>%s</td><td>%s</td><td>%d</td><td>%.3f</td><td>%+.1f %+.1f %+.1f</td></tr>\n",
                     escaped(pair.a).c_str(), escaped(pair.b).c_str(), pair.views, pair.rms,
                     1e3 * pair.offset.x(), 1e3 * pair.offset.y(), 1e3 * pair.offset.z());
  }
  return out + "</table></div>\n";
}

/// Which sensors have data in a view that the result does not know of.
std::string files_of(const SessionView& view) {
  std::string list;
  for (const auto* files : {&view.images, &view.clouds}) {
    for (const auto& [sensor, file] : *files) list += (list.empty() ? "" : ", ") + sensor;
  }
  return list;
}

}  // namespace

std::string pictures_section(const ReportInput& input) {
  if (input.pictures.empty()) return {};
  std::string out =
      "<h2>LiDAR on the pictures</h2>\n<input type=radio name=show id=ranges checked><label for=ranges>by "
      "range</label>"
      "<input type=radio name=show id=residuals><label for=residuals>the board, by residual</label>\n<div "
      "class=views>\n";
  for (const ReportPicture& p : input.pictures) {
    const std::string name =
        formatted("View %d: %s on %s", p.view, escaped(p.lidar).c_str(), escaped(p.camera).c_str());
    out += "<figure><div class=range><img loading=lazy alt=\"" + name + "\" src=\"" +
           data_uri("image/jpeg", p.overlay) +
           formatted("\"><figcaption>%s. %.1f m <span class=scale></span> %.1f m</figcaption></div>\n",
                     name.c_str(), p.near, p.far);
    if (p.residuals.empty()) {
      out += "<div class=residual><figcaption>" + name +
             ": no residuals are known</figcaption></div></figure>\n";
      continue;
    }
    out += "<div class=residual><img loading=lazy alt=\"" + name + ", residuals\" src=\"" +
           data_uri("image/jpeg", p.residuals) +
           formatted(
               "\"><figcaption>%s. Range error %+.0f mm <span class=\"scale signed\"></span> %+.0f mm; "
               "corners' errors "
               "%.0f times</figcaption></div></figure>\n",
               name.c_str(), -1e3 * p.residual_scale, 1e3 * p.residual_scale, p.magnified);
  }
  out += "</div>\n";
  if (!input.cloud.empty()) {
    out += "<h3>The cloud in the camera's colours</h3><figure><img alt=\"coloured cloud\" src=\"" +
           data_uri("image/jpeg", input.cloud) +
           "\"><figcaption>From behind the camera; dark grey: outside its view or "
           "hidden from it. report/cloud.ply has the coloured points.</figcaption></figure>\n";
  }
  return out;
}

std::string evidence_section(const ReportInput& input) {
  if (!input.evidence || !input.calibration) return {};
  const Observability& seen = input.calibration->observability;
  std::string out =
      "<h2>Observability</h2><p>Least certain: " + escaped(seen.weakest_direction) +
      formatted(
          ". The largest standard deviation is %.1f times the smallest. Boards tilted in different "
          "directions (dots spread over the discs) and spread over the picture make every direction "
          "certain.</p>\n",
          seen.condition);
  out += "<div class=plots>\n" + coverage_plots(*input.evidence, *input.calibration) + "</div>\n";
  out += "<h2>Residuals</h2><div class=plots>\n" + residual_plots(*input.evidence) + "</div>\n" +
         stereo(*input.evidence);
  out += "<h2>Error against the number of views</h2><div class=plots>\n" + settling_plots(*input.evidence) +
         "</div>\n";
  return out;
}

std::string views_section(const ReportInput& input) {
  std::set<int> told;
  double largest_pixel = 1e-9, largest_plane = 1e-9;
  const std::vector<CalibratedView> outcomes =
      input.calibration ? input.calibration->views : std::vector<CalibratedView>{};
  for (const CalibratedView& view : outcomes) {
    if (!view.used) continue;
    largest_pixel = std::max(largest_pixel, view.reprojection_rms);
    largest_plane = std::max(largest_plane, view.plane_rms);
  }
  std::string rows;
  for (const CalibratedView& view : outcomes) {
    told.insert(view.id);
    if (!view.used) {
      rows += formatted("<tr><td>%d</td><td colspan=4 class=reason>not used: %s</td></tr>\n", view.id,
                        escaped(view.reason).c_str());
      continue;
    }
    const auto bar = [](double share) {
      return formatted("<td class=words><span class=bar style=\"width:%.1frem\"></span></td>", 5 * share);
    };
    rows += formatted("<tr><td>%d</td><td>%.3f</td>", view.id, view.reprojection_rms) +
            bar(view.reprojection_rms / largest_pixel) + formatted("<td>%.1f</td>", 1e3 * view.plane_rms) +
            bar(view.plane_rms / largest_plane) + "</tr>\n";
  }
  if (input.session) {
    for (const SessionView& view : input.session->views) {
      if (told.count(view.id)) continue;
      rows += formatted("<tr><td>%d</td><td colspan=4 class=reason>not in the result; data of %s</td></tr>\n",
                        view.id, escaped(files_of(view)).c_str());
    }
  }
  if (rows.empty()) return {};
  return "<h2>Views</h2><div class=scroll><table><tr><th>view</th><th>reprojection, "
         "px</th><th></th><th>plane, mm</th><th></th></tr>\n" +
         rows + "</table></div>\n";
}

std::string provenance_section(const ReportInput& input) {
  std::string out = "<h2>Provenance</h2>\n";
  if (input.calibration) {
    out += "<p>Solved by " + escaped(input.calibration->software) + ", method " +
           escaped(input.calibration->method) + ".</p>\n";
  }
  if (input.provenance.empty()) return out;
  out += "<details><summary>Sensors and the SHA-256 of every file</summary><div class=scroll><table>\n";
  for (const auto& [subject, value] : input.provenance) {
    out += "<tr><td>" + escaped(subject) + "</td><td class=reason><code>" + escaped(value) +
           "</code></td></tr>\n";
  }
  return out + "</table></div></details>\n";
}

}  // namespace ca2
