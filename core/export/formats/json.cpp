/// Everything, for programs. Quaternions have named components, matrices are row by row, 17 digits.
#include <nlohmann/json.hpp>

#include "core/export/selection.h"

namespace ca2 {
namespace {

using Json = nlohmann::ordered_json;

Json pose_json(const Pose& T) {
  const Eigen::Quaterniond q = T.quaternion();
  Json matrix = Json::array();
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) matrix.push_back(T.R(i, k));
    matrix.push_back(T.t(i));
  }
  for (const double value : {0, 0, 0, 1}) matrix.push_back(value);
  return {{"translation", {{"x", T.t.x()}, {"y", T.t.y()}, {"z", T.t.z()}}},
          {"rotation", {{"qx", q.x()}, {"qy", q.y()}, {"qz", q.z()}, {"qw", q.w()}}},
          {"matrix_row_major", matrix}};
}

Json transform_json(const ExportTransform& t) {
  Json json{{"parent_frame", t.parent}, {"child_frame", t.child}};
  json.update(pose_json(t.connection.T));
  json["inverse"] = pose_json(t.connection.T.inverse());
  json["estimated"] = t.connection.estimated;
  json["covariance"] = nullptr;
  if (t.connection.covariance) {
    json["covariance"] = Json::array();
    for (int i = 0; i < 36; ++i) json["covariance"].push_back((*t.connection.covariance)(i / 6, i % 6));
  }
  return json;
}

}  // namespace

Result<ExportFiles> export_json(const ExportRequest& request) {
  const auto transforms = select_default_tree(request);
  if (!transforms) return fail(transforms.error());
  Json json{{"version", 1}, {"session", request.session}};
  json["conventions"] = {
      {"transform", "p_parent = T_parent_child p_child; m"},
      {"covariance",
       "6x6 row by row, order rotation x y z [rad], translation x y z [m]; right perturbation: T_true = "
       "T_parent_child (Exp(rotation), translation); null: not known"}};
  json["transforms"] = Json::array();
  for (const ExportTransform& t : *transforms) json["transforms"].push_back(transform_json(t));
  json["calibration"] = Json::parse(to_json(request.calibration));
  json["provenance"] = Json::object();
  for (const ProvenanceEntry& entry : request.provenance) json["provenance"][entry.subject] = entry.value;
  return ExportFiles{{"calibration.json", json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"}};
}

}  // namespace ca2
