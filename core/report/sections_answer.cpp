/// Verdict, extrinsics, sensors: the answer itself.
#include <algorithm>
#include <cmath>

#include "core/export/rpy.h"
#include "core/geometry/adjoint.h"
#include "core/report/html.h"
#include "core/report/sections.h"
#include "core/types/counted.h"
#include "core/types/text.h"

namespace ca2 {
namespace {

constexpr double degrees = 180 / M_PI;

/// What the uncertainty of a camera-LiDAR pair means at a distance: pixels by which a LiDAR point is off, 1
/// sigma.
double pixels_off(const CalibratedTransform& t, const Camera& camera, double distance) {
  const double per_axis_rotation = t.sigma_rotation() / std::sqrt(3),
               per_axis_translation = t.sigma_translation() / std::sqrt(3);
  return camera.parameters(0) * std::hypot(per_axis_rotation, per_axis_translation / distance) * std::sqrt(2);
}

std::string answer_in_words(const Calibration& calibration) {
  const std::string& verdict = calibration.observability.verdict;
  std::string out =
      "<p class=\"verdict " + escaped(verdict) + "\">Verdict: " + escaped(verdict) + "</p>\n<p>";
  if (verdict == "good") {
    out += "The views determine the answer in every direction. ";
  } else {
    out += "The views give an answer, but a weak one: take more, as said below, before relying on it. ";
  }
  for (const CalibratedTransform& t : calibration.transforms) {
    const auto camera = calibration.cameras.find(t.parent);
    if (camera == calibration.cameras.end() || calibration.cameras.count(t.child)) continue;
    out += formatted(
        "<b>%s</b> relative to <b>%s</b> is known to %.1f mm and %.2f mrad (1 sigma): a LiDAR point 5 m away "
        "lands within %.1f px of where it belongs. ",
        escaped(t.child).c_str(), escaped(t.parent).c_str(), 1e3 * t.sigma_translation(),
        1e3 * t.sigma_rotation(), pixels_off(t, camera->second.camera, 5));
  }
  return out + "</p>\n";
}

std::string checks_in_words(const Calibration& calibration) {
  const Validation& checked = calibration.validation;
  const auto used =
      std::count_if(calibration.views.begin(), calibration.views.end(), [](const auto& v) { return v.used; });
  std::string out = formatted("<p>%ld of %s used. Least certain: %s. ", static_cast<long>(used),
                              counted(calibration.views.size(), "view").c_str(),
                              escaped(calibration.observability.weakest_direction).c_str());
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

std::string transform_rows(const std::string& parent, const std::string& child, const Pose& T,
                           const Matrix6d& covariance) {
  const Eigen::Quaterniond q = T.quaternion();
  const Eigen::Vector3d rpy = degrees * rpy_from_rotation(T.R);
  std::string out = formatted("<tr><td>T_%s_%s</td>", escaped(parent).c_str(), escaped(child).c_str());
  // The translation's deviation is along the parent's axes: a right perturbation is in the child's.
  const Eigen::Matrix3d C = T.R * covariance.bottomRightCorner<3, 3>() * T.R.transpose();
  for (int i = 0; i < 3; ++i)
    out += formatted("<td>%+.5f <small>&plusmn; %.2f mm</small></td>", T.t(i), 1e3 * std::sqrt(C(i, i)));
  for (int i = 0; i < 3; ++i) out += formatted("<td>%+.3f</td>", rpy(i));
  const double sigma_r = std::sqrt(covariance.topLeftCorner<3, 3>().trace()), sigma_t = std::sqrt(C.trace());
  return out + formatted("<td>%.2f mm, %.2f mrad</td><td>%+.6f %+.6f %+.6f %+.6f</td></tr>\n", 1e3 * sigma_t,
                         1e3 * sigma_r, q.x(), q.y(), q.z(), q.w());
}

}  // namespace

std::string verdict_section(const ReportInput& input) {
  std::string out;
  if (!input.missing.empty()) {
    out += input.calibration
               ? "<h2>What is missing</h2><ul>\n"
               : "<p class=\"verdict missing\">Not calibrated</p>\n<p>What is missing:</p><ul>\n";
    for (const std::string& line : input.missing) out += "<li>" + escaped(line) + "</li>\n";
    out += "</ul>\n";
  }
  if (!input.calibration) return out;
  std::string answer;
  if (input.outdated) {
    answer = "<p class=\"verdict missing\">Outdated</p>\n<p>" +
             escaped(Error(ErrorCode::data, {*input.outdated}).text()) + "</p>\n";
  }
  answer += answer_in_words(*input.calibration) + checks_in_words(*input.calibration);
  for (const std::string& note : input.calibration->notes) answer += "<p>Note: " + escaped(note) + "</p>\n";
  return answer + out;
}

std::string transforms_section(const Calibration& calibration) {
  std::string out =
      "<h2>Extrinsics</h2><p><code>T_a_b</code> maps points of b to a: <code>p_a = T_a_b p_b</code>, and is "
      "the pose of b "
      "in a. Metres; roll, pitch, yaw about fixed axes in degrees; quaternion x, y, z, w.</p>\n<div "
      "class=scroll><table>"
      "<tr><th></th><th>x</th><th>y</th><th>z</th><th>roll</th><th>pitch</th><th>yaw</th><th>sigma</"
      "th><th>qx qy qz qw</th></tr>\n";
  for (const CalibratedTransform& t : calibration.transforms) {
    const Matrix6d Ad = adjoint(t.T_parent_child);
    out += transform_rows(t.parent, t.child, t.T_parent_child, t.covariance);
    out += transform_rows(t.child, t.parent, t.T_parent_child.inverse(), Ad * t.covariance * Ad.transpose());
  }
  return out + "</table></div>\n";
}

std::string sensors_section(const Calibration& calibration) {
  std::string out =
      "<h2>Sensors</h2>\n<div "
      "class=scroll><table><tr><th>camera</th><th>model</th><th>parameters</th></tr>\n";
  for (const auto& [name, calibrated] : calibration.cameras) {
    const Camera& camera = calibrated.camera;
    out += "<tr><td>" + escaped(name) + "</td><td>" + std::string(camera.model->name()) +
           (calibrated.estimated ? " (estimated from the views)" : "") + "</td><td class=reason>";
    for (Eigen::Index k = 0; k < camera.parameters.size(); ++k) {
      const auto i = static_cast<std::size_t>(k);
      out += (k ? ", " : "") + std::string(camera.model->parameter_names()[i]) +
             formatted(" %.6g", camera.parameters(k));
      if (i < calibrated.sigma.size() && calibrated.sigma[i] > 0)
        out += formatted(" &plusmn; %.2g", calibrated.sigma[i]);
    }
    out += "</td></tr>\n";
  }
  out +=
      "</table></div>\n<div class=scroll><table><tr><th>LiDAR</th><th>noise of a return</th><th>range "
      "bias</th></tr>\n";
  for (const auto& [name, lidar] : calibration.lidars) {
    out += formatted("<tr><td>%s</td><td>%.1f mm</td>", escaped(name).c_str(), 1e3 * lidar.range_sigma);
    out += lidar.estimated ? formatted("<td>%+.1f &plusmn; %.1f mm</td></tr>\n", 1e3 * lidar.range_bias,
                                       1e3 * lidar.range_bias_sigma)
                           : std::string("<td>not estimated</td></tr>\n");
  }
  return out + "</table></div>\n";
}

}  // namespace ca2
