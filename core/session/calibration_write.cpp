#include <nlohmann/json.hpp>

#include "core/io/yaml_text.h"
#include "core/session/calibration.h"
#include "core/session/pose_yaml.h"

namespace ca2 {
namespace {

using Json = nlohmann::ordered_json;

constexpr double per_milli = 1000;  // m to mm, rad to mrad

/// Sensor frames in the file's terms.
const std::string& frame_of(const std::string& frame, const std::string& sensor) {
  return frame.empty() ? sensor : frame;
}

void write_transform(std::string& out, const CalibratedTransform& transform) {
  const CalibratedTransform& t = transform;
  out += "  - parent: " + yaml_string(t.parent) + "\n";
  out += "    child: " + yaml_string(t.child) + "\n";
  out += "    parent_frame: " + yaml_string(frame_of(t.parent_frame, t.parent)) + "\n";
  out += "    child_frame: " + yaml_string(frame_of(t.child_frame, t.child)) + "\n";
  out += "    # T_parent_child: p_parent = rotation * p_child + translation [m]\n";
  out += "    translation: " + translation_text(t.T_parent_child) + "\n";
  out += "    rotation: " + rotation_text(t.T_parent_child) + "\n";
  out += "    # 6x6, row by row; order: rotation x y z [rad], translation x y z [m]; right perturbation:\n";
  out += "    # T_true = T_parent_child * (Exp(rotation), translation)\n";
  out += "    covariance:\n";
  for (int row = 0; row < 6; ++row) {
    out += row == 0 ? "      [" : "       ";
    for (int column = 0; column < 6; ++column) {
      out += exact(t.covariance(row, column)) + (column < 5 ? ", " : "");
    }
    out += row == 5 ? "]\n" : ",\n";
  }
  out += "    sigma_translation_mm: " + exact(per_milli * t.sigma_translation()) + "\n";
  out += "    sigma_rotation_mrad: " + exact(per_milli * t.sigma_rotation()) + "\n";
}

void write_camera(std::string& out, const std::string& name, const CalibratedCamera& calibrated) {
  const Camera& camera = calibrated.camera;
  out += "  " + yaml_string(name) + ":\n";
  out += "    model: " + yaml_string(camera.model->name()) + "\n";
  if (camera.width > 0) {
    out += "    image_size: [" + std::to_string(camera.width) + ", " + std::to_string(camera.height) + "]\n";
  }
  out += "    parameters: " + exact_list(camera.parameters) + "\n";
  out += std::string("    estimated: ") + (calibrated.estimated ? "true" : "false") + "\n";
  out += "    sigma: " + exact_list(calibrated.sigma.data(), calibrated.sigma.size()) + "\n";
}

void write_lidar(std::string& out, const std::string& name, const CalibratedLidar& lidar) {
  out += "  " + yaml_string(name) + ": {range_bias: " + exact(lidar.range_bias) +
         ", range_bias_sigma: " + exact(lidar.range_bias_sigma) +
         ", range_sigma: " + exact(lidar.range_sigma) +
         ", estimated: " + (lidar.estimated ? "true" : "false") + "}\n";
}

void write_view(std::string& out, const CalibratedView& view) {
  out += "  - {id: " + std::to_string(view.id) + ", used: " + (view.used ? "true" : "false") +
         ", reason: " + yaml_string(view.reason) + ", reprojection_rms_px: " + exact(view.reprojection_rms) +
         ", plane_rms_mm: " + exact(per_milli * view.plane_rms) + "}\n";
}

std::string digests_text(const std::map<std::string, std::string>& digests) {
  std::string out;
  for (const auto& [name, digest] : digests) {
    out += (out.empty() ? "" : ", ") + yaml_string(name) + ": " + yaml_string(digest);
  }
  return "{" + out + "}";
}

void write_inputs(std::string& out, const CalibrationInputs& inputs) {
  out += "inputs:  # digests of what this was made of: it is told when the session holds something else\n";
  out += "  rig: " + digests_text(inputs.rig) + "\n";
  out += std::string("  views:") + (inputs.views.empty() ? " {}" : "") + "\n";
  for (const auto& [id, files] : inputs.views) {
    out += "    " + std::to_string(id) + ": " + digests_text(files) + "\n";
  }
}

/// "name:" and its entries, or "name: []" / "{}".
template <class Entries, class Write>
void write_section(std::string& out, const char* name, const char* empty, const Entries& entries,
                   Write write) {
  out += std::string(name) + ":" + (entries.empty() ? std::string(" ") + empty : "") + "\n";
  for (const auto& entry : entries) write(entry);
}

Json transform_json(const CalibratedTransform& t) {
  const Eigen::Quaterniond q = t.T_parent_child.quaternion();
  const Eigen::Vector3d& p = t.T_parent_child.t;
  Json covariance = Json::array();
  for (int i = 0; i < 36; ++i) covariance.push_back(t.covariance(i / 6, i % 6));
  return {{"parent", t.parent},
          {"child", t.child},
          {"parent_frame", frame_of(t.parent_frame, t.parent)},
          {"child_frame", frame_of(t.child_frame, t.child)},
          {"translation", {p.x(), p.y(), p.z()}},
          {"rotation", {{"x", q.x()}, {"y", q.y()}, {"z", q.z()}, {"w", q.w()}}},
          {"covariance", std::move(covariance)},
          {"sigma_translation_mm", per_milli * t.sigma_translation()},
          {"sigma_rotation_mrad", per_milli * t.sigma_rotation()}};
}

Json camera_json(const CalibratedCamera& calibrated) {
  const Camera& camera = calibrated.camera;
  Json json{{"model", std::string(camera.model->name())}};
  if (camera.width > 0) json["image_size"] = {camera.width, camera.height};
  json["parameters"] = std::vector<double>(camera.parameters.begin(), camera.parameters.end());
  json["estimated"] = calibrated.estimated;
  json["sigma"] = calibrated.sigma;
  return json;
}

}  // namespace

std::string to_yaml(const Calibration& calibration) {
  const Calibration& c = calibration;
  std::string out = "version: 1\n";
  out += "software: " + yaml_string(c.software) + "\n";
  out += "method: " + yaml_string(c.method) + "\n";
  write_section(out, "transforms", "[]", c.transforms, [&](const auto& t) { write_transform(out, t); });
  write_section(out, "cameras", "{}", c.cameras,
                [&](const auto& entry) { write_camera(out, entry.first, entry.second); });
  write_section(out, "lidars", "{}", c.lidars,
                [&](const auto& entry) { write_lidar(out, entry.first, entry.second); });
  if (c.print.estimated) {
    out += "print: {stretch: " + exact_list(c.print.stretch.data(), 2) +
           ", sigma: " + exact_list(c.print.sigma.data(), 2) + "}\n";
  }
  out += "observability: {verdict: " + yaml_string(c.observability.verdict) +
         ", weakest_direction: " + yaml_string(c.observability.weakest_direction) +
         ", condition: " + exact(c.observability.condition) + "}\n";
  for (std::size_t i = 0; i < c.notes.size(); ++i) {
    out += (i == 0 ? "notes:\n  - " : "  - ") + yaml_string(c.notes[i]) + "\n";
  }
  const Validation& v = c.validation;
  out += "validation:\n";
  out += "  leave_one_out: {translation_mm: " + exact(per_milli * v.leave_one_out_translation) +
         ", rotation_mrad: " + exact(per_milli * v.leave_one_out_rotation) + "}\n";
  out += "  outline_offset_mm: " + (v.outline_offset ? exact(per_milli * *v.outline_offset) : "null") + "\n";
  out += "  reprojection_rms_px: " + exact(v.reprojection_rms) + "\n";
  out += "  range_rms_mm: " + exact(per_milli * v.range_rms) + "\n";
  write_section(out, "views", "[]", c.views, [&](const auto& view) { write_view(out, view); });
  if (c.inputs) write_inputs(out, *c.inputs);
  return out;
}

std::string to_json(const Calibration& calibration) {
  const Calibration& c = calibration;
  Json json{{"version", 1}, {"software", c.software}, {"method", c.method}};
  json["transforms"] = Json::array();
  for (const auto& transform : c.transforms) json["transforms"].push_back(transform_json(transform));
  json["cameras"] = Json::object();
  for (const auto& [name, camera] : c.cameras) json["cameras"][name] = camera_json(camera);
  json["lidars"] = Json::object();
  for (const auto& [name, lidar] : c.lidars) {
    json["lidars"][name] = {{"range_bias", lidar.range_bias},
                            {"range_bias_sigma", lidar.range_bias_sigma},
                            {"range_sigma", lidar.range_sigma},
                            {"estimated", lidar.estimated}};
  }
  if (c.print.estimated) {
    json["print"] = {{"stretch", {c.print.stretch.x(), c.print.stretch.y()}},
                     {"sigma", {c.print.sigma.x(), c.print.sigma.y()}}};
  }
  json["observability"] = {{"verdict", c.observability.verdict},
                           {"weakest_direction", c.observability.weakest_direction},
                           {"condition", c.observability.condition}};
  if (!c.notes.empty()) json["notes"] = c.notes;
  const Validation& v = c.validation;
  json["validation"] = {
      {"leave_one_out",
       {{"translation_mm", per_milli * v.leave_one_out_translation},
        {"rotation_mrad", per_milli * v.leave_one_out_rotation}}},
      {"outline_offset_mm", v.outline_offset ? Json(per_milli * *v.outline_offset) : Json()},
      {"reprojection_rms_px", v.reprojection_rms},
      {"range_rms_mm", per_milli * v.range_rms}};
  json["views"] = Json::array();
  for (const CalibratedView& view : c.views) {
    json["views"].push_back({{"id", view.id},
                             {"used", view.used},
                             {"reason", view.reason},
                             {"reprojection_rms_px", view.reprojection_rms},
                             {"plane_rms_mm", per_milli * view.plane_rms}});
  }
  if (c.inputs) {
    Json& inputs = json["inputs"] = {{"rig", c.inputs->rig}, {"views", Json::object()}};
    for (const auto& [id, files] : c.inputs->views) inputs["views"][std::to_string(id)] = files;
  }
  // A number that is not finite becomes null, a byte that is no UTF-8 the replacement character.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace ca2
