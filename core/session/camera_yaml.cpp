#include "core/session/camera_yaml.h"

#include <cmath>

namespace ca2 {
namespace {

/// "fx fy cx cy k1 k2 p1 p2 [k3]"
std::string signature(const CameraModel& model) {
  const auto names = model.parameter_names();
  const std::size_t required = names.size() - static_cast<std::size_t>(model.optional_parameters());
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    text += (i ? " " : "") + (i < required ? std::string(names[i]) : "[" + std::string(names[i]) + "]");
  }
  return text;
}

}  // namespace

const CameraModel* read_model(YamlReader& reader, const YamlNode* node) {
  const auto name = reader.text(node);
  if (!name) return nullptr;
  const CameraModel* model = find_camera_model(*name);
  if (!model) {
    std::vector<std::string_view> names;
    for (const CameraModel* known : camera_models()) names.push_back(known->name());
    reader.problem(*node, "there is no camera model '" + *name + "'", suggest(*name, names));
  }
  return model;
}

std::optional<CameraParameters> read_parameters(YamlReader& reader, const YamlNode* node,
                                                const CameraModel& model) {
  const auto values = reader.numbers(node, 0, 1e9);
  if (!values) return std::nullopt;
  const std::size_t most = model.parameter_names().size();
  const std::size_t least = most - static_cast<std::size_t>(model.optional_parameters());
  if (values->size() < least || values->size() > most) {
    reader.problem(*node,
                   std::string(model.name()) + " takes " +
                       (least < most ? std::to_string(least) + " or " : "") + std::to_string(most) +
                       " parameters, not " + std::to_string(values->size()),
                   "in this order: " + signature(model));
    return std::nullopt;
  }
  const CameraParameters parameters =
      Eigen::Map<const Eigen::VectorXd>(values->data(), static_cast<Eigen::Index>(values->size()));
  if (const auto reason = model.invalid(parameters)) {
    reader.problem(*node, "this is no " + std::string(model.name()) + " camera: " + *reason,
                   "the order is " + signature(model));
    return std::nullopt;
  }
  return parameters;
}

}  // namespace ca2
