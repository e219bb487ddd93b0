#include "core/report/html_report.h"

#include <algorithm>
#include <cmath>

#include "core/types/text.h"

namespace ca2 {
namespace {

std::string escaped(const std::string& raw) {
  std::string out;
  for (const char c : raw) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string base64(const std::string& bytes) {
  static constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve(4 * (bytes.size() + 2) / 3);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned word = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      word = word << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      out += i + k <= bytes.size() ? digits[word >> (18 - 6 * k) & 63] : '=';
    }
  }
  return out;
}

const char* style = R"(<style>
:root{color-scheme:light dark;--line:#8884;--bar:#4a7ebb;--good:#1a7f37;--weak:#b35900}
body{font:16px/1.5 system-ui,sans-serif;max-width:75rem;margin:1.5rem auto;padding:0 1rem}
h1{font-size:1.5rem}h2{font-size:1.15rem;margin-top:2rem}
.scroll{overflow-x:auto}table{border-collapse:collapse;font-variant-numeric:tabular-nums}
th,td{padding:.25rem .6rem;white-space:nowrap;border-bottom:1px solid var(--line);text-align:right}
th:first-child,td:first-child,td.words{text-align:left}td.reason{text-align:left;white-space:normal}
.verdict{font-size:1.25rem;font-weight:600}.good{color:var(--good)}.weak{color:var(--weak)}
.bar{display:inline-block;height:.7rem;background:var(--bar);vertical-align:middle}
img{width:100%;height:auto;display:block}figure{margin:1rem 0}figcaption{font-size:.9rem}
.scale{display:inline-block;width:8rem;height:.7rem;vertical-align:middle;background:linear-gradient(90deg,red,yellow,lime,cyan,blue)}
code,pre{font-size:.9rem}pre{overflow-x:auto}@media print{figure{break-inside:avoid}}
</style>)";

std::string transform_rows(const std::string& parent, const std::string& child, const Pose& T,
                           const std::string& sigma) {
  const Eigen::Quaterniond q = T.quaternion();
  return formatted(
      "<tr><td>T_%s_%s</td><td>%+.5f</td><td>%+.5f</td><td>%+.5f</td><td>%+.6f</td><td>%+.6f</td><td>%+.6f</"
      "td>"
      "<td>%+.6f</td><td>%s</td></tr>\n",
      escaped(parent).c_str(), escaped(child).c_str(), T.t.x(), T.t.y(), T.t.z(), q.x(), q.y(), q.z(), q.w(),
      sigma.c_str());
}

std::string transforms(const Calibration& calibration) {
  std::string out =
      "<h2>Extrinsics</h2><p><code>T_a_b</code> maps points of frame b to frame a: metres, quaternion (x, y, "
      "z, w).</p>"
      "<div "
      "class=scroll><table><tr><th></th><th>x</th><th>y</th><th>z</th><th>qx</th><th>qy</th><th>qz</"
      "th><th>qw</th>"
      "<th>sigma</th></tr>\n";
  for (const CalibratedTransform& t : calibration.transforms) {
    const std::string sigma =
        formatted("%.2f mm, %.2f mrad", 1e3 * t.sigma_translation(), 1e3 * t.sigma_rotation());
    out += transform_rows(t.parent, t.child, t.T_parent_child, sigma);
    out += transform_rows(t.child, t.parent, t.T_parent_child.inverse(), "");
  }
  return out + "</table></div>\n";
}

std::string sensors(const Calibration& calibration) {
  std::string out = "<h2>Sensors</h2><ul>\n";
  for (const auto& [name, camera] : calibration.cameras) {
    out += formatted("<li>camera <b>%s</b>: %s", escaped(name).c_str(),
                     std::string(camera.camera.model->name()).c_str());
    for (Eigen::Index k = 0; k < camera.camera.parameters.size(); ++k) {
      out += formatted(" %.6g", camera.camera.parameters(k));
      if (static_cast<std::size_t>(k) < camera.sigma.size() &&
          camera.sigma[static_cast<std::size_t>(k)] > 0) {
        out += formatted(" &plusmn; %.2g", camera.sigma[static_cast<std::size_t>(k)]);
      }
      out += k + 1 < camera.camera.parameters.size() ? "," : "";
    }
    out += "</li>\n";
  }
  for (const auto& [name, lidar] : calibration.lidars) {
    out += formatted("<li>LiDAR <b>%s</b>: %.1f mm noise per return", escaped(name).c_str(),
                     1e3 * lidar.range_sigma);
    if (lidar.estimated) {
      out += formatted("; range bias %+.1f &plusmn; %.1f mm", 1e3 * lidar.range_bias,
                       1e3 * lidar.range_bias_sigma);
    }
    out += "</li>\n";
  }
  return out + "</ul>\n";
}

std::string views(const Calibration& calibration) {
  double largest_pixel = 1e-9;
  double largest_plane = 1e-9;
  for (const CalibratedView& view : calibration.views) {
    if (!view.used) continue;
    largest_pixel = std::max(largest_pixel, view.reprojection_rms);
    largest_plane = std::max(largest_plane, view.plane_rms);
  }
  std::string out =
      "<h2>Views</h2><div class=scroll><table><tr><th>view</th><th>reprojection, px</th><th></th><th>plane, "
      "mm</th><th></th>"
      "<th></th></tr>\n";
  for (const CalibratedView& view : calibration.views) {
    if (!view.used) {
      out += formatted("<tr><td>%d</td><td colspan=5 class=reason>not used: %s</td></tr>\n", view.id,
                       escaped(view.reason).c_str());
      continue;
    }
    out += formatted(
        "<tr><td>%d</td><td>%.3f</td><td class=words><span class=bar "
        "style=\"width:%.1frem\"></span></td><td>%.1f</td>"
        "<td class=words><span class=bar style=\"width:%.1frem\"></span></td><td></td></tr>\n",
        view.id, view.reprojection_rms, 6 * view.reprojection_rms / largest_pixel, 1e3 * view.plane_rms,
        6 * view.plane_rms / largest_plane);
  }
  return out + "</table></div>\n";
}

std::string verdict(const Calibration& calibration) {
  const Observability& seen = calibration.observability;
  const Validation& checked = calibration.validation;
  std::string out = formatted("<p class=\"verdict %s\">Verdict: %s</p><p>", escaped(seen.verdict).c_str(),
                              escaped(seen.verdict).c_str());
  const auto used =
      std::count_if(calibration.views.begin(), calibration.views.end(), [](const auto& v) { return v.used; });
  out += formatted("%ld of %zu views used. Least certain: %s. ", static_cast<long>(used),
                   calibration.views.size(), escaped(seen.weakest_direction).c_str());
  if (std::isfinite(checked.leave_one_out_translation)) {
    out += formatted("Leaving any one view out moves the answer by %.2f mm and %.2f mrad (rms). ",
                     1e3 * checked.leave_one_out_translation, 1e3 * checked.leave_one_out_rotation);
  } else {
    out += "Too few views to check the answer by leaving one out. ";
  }
  if (checked.outline_offset) {
    out += formatted(
        "The plates' outlines sit %.1f mm (mean) from where the answer without them has the plates. ",
        1e3 * *checked.outline_offset);
  }
  return out + formatted("Reprojection %.3f px rms, ranges %.1f mm rms.</p>\n", checked.reprojection_rms,
                         1e3 * checked.range_rms);
}

}  // namespace

std::string html_report(const ReportInput& input) {
  std::string out =
      "<!doctype html>\n<html lang=en><head><meta charset=utf-8>"
      "<meta name=viewport content=\"width=device-width,initial-scale=1\"><title>" +
      escaped(input.title) + "</title>\n" + style + "</head><body>\n<h1>" + escaped(input.title) + "</h1>\n";
  out += verdict(input.calibration);
  for (const std::string& note : input.calibration.notes) out += "<p>Note: " + escaped(note) + "</p>\n";
  out += transforms(input.calibration) + sensors(input.calibration) + views(input.calibration);
  if (!input.problems.empty()) {
    out += "<h2>Problems</h2><ul>\n";
    for (const Problem& problem : input.problems) {
      out += "<li>" + escaped(Error(ErrorCode::data, {problem}).text()) + "</li>\n";
    }
    out += "</ul>\n";
  }
  if (!input.pictures.empty()) out += "<h2>LiDAR points on the pictures</h2>\n";
  for (const ReportPicture& picture : input.pictures) {
    out +=
        formatted("<figure><img alt=\"view %d\" src=\"data:image/jpeg;base64,", picture.view) +
        base64(picture.jpeg) + "\">" +
        formatted(
            "<figcaption>View %d: %s on %s. %.1f m <span class=scale></span> %.1f m</figcaption></figure>\n",
            picture.view, escaped(picture.lidar).c_str(), escaped(picture.camera).c_str(), picture.near,
            picture.far);
  }
  return out + formatted("<p><small>%s, method %s.</small></p>\n</body></html>\n",
                         escaped(input.calibration.software).c_str(),
                         escaped(input.calibration.method).c_str());
}

}  // namespace ca2
