#include "core/session/intrinsics_nodes.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/session/intrinsics_file.h"

namespace ca2 {

void IntrinsicsNodes::add(const YAML::Node& node, std::string what, std::string hint) {
  std::string where = file;
  if (node.IsDefined() && node.Mark().line >= 0) {
    where += ":" + std::to_string(node.Mark().line + 1) + ":" + std::to_string(node.Mark().column + 1);
  }
  problems.push_back({where, std::move(what), std::move(hint)});
}

YAML::Node IntrinsicsNodes::find(const YAML::Node& map, std::initializer_list<const char*> keys) {
  if (map.IsDefined() && map.IsMap()) {
    for (const char* key : keys) {
      if (const YAML::Node child = map[key]) return child;
    }
  }
  return YAML::Node(YAML::NodeType::Undefined);
}

YAML::Node IntrinsicsNodes::need(const YAML::Node& map, std::initializer_list<const char*> keys) {
  const YAML::Node child = find(map, keys);
  if (!child.IsDefined()) add(map, "'" + std::string(*keys.begin()) + "' is missing");
  return child;
}

double IntrinsicsNodes::number(const YAML::Node& node, const std::string& name) {
  if (!node.IsDefined() || !node.IsScalar()) {
    add(node, name + " is not a number");
    return 0;
  }
  const std::string& text = node.Scalar();
  const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
  double value = 0;
  const auto [end, error] = std::from_chars(begin, text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
    add(node, name + " is not a finite number: '" + text.substr(0, 40) + "'");
    return 0;
  }
  return value;
}

std::vector<double> IntrinsicsNodes::numbers(const YAML::Node& node, const std::string& name) {
  std::vector<double> values;
  if (!node.IsDefined()) return values;  // the miss is already a problem
  const bool matrix = node.IsMap();
  const YAML::Node list = matrix ? need(node, {"data"}) : node;
  if (!list.IsDefined()) return values;
  if (!list.IsSequence() || list.size() > 64) {
    add(list, name + " is not a list of numbers");
    return values;
  }
  for (const YAML::Node& item : list) values.push_back(number(item, name));
  if (matrix) {
    const YAML::Node rows = find(node, {"rows"}), columns = find(node, {"cols"});
    if (rows.IsDefined() && columns.IsDefined() &&
        number(rows, name + "'s rows") * number(columns, name + "'s cols") !=
            static_cast<double>(values.size())) {
      add(node, name + ": rows times cols is not the count of its data (" + std::to_string(values.size()) +
                    " numbers)");
    }
  }
  return values;
}

int IntrinsicsNodes::pixels(const YAML::Node& node, const std::string& name) {
  if (!node.IsDefined()) return 0;  // the miss is already a problem
  const std::size_t before = problems.size();
  const double value = number(node, name);
  if (problems.size() > before) return 0;
  if (!(value >= 1 && value <= max_image_side) || value != std::floor(value)) {
    add(node, name + " is not a whole number of pixels from 1 to " + std::to_string(max_image_side));
    return 0;
  }
  return static_cast<int>(value);
}

std::string IntrinsicsNodes::text(const YAML::Node& node) {
  return node.IsDefined() && node.IsScalar() ? node.Scalar() : std::string();
}

Result<Camera> IntrinsicsNodes::finish(const YAML::Node& node, std::string_view model,
                                       const std::vector<double>& parameters, int width, int height) {
  if (problems.empty()) {
    Camera camera;
    camera.model = find_camera_model(model);
    camera.parameters = Eigen::Map<const Eigen::VectorXd>(
        parameters.data(),
        std::min<Eigen::Index>(static_cast<Eigen::Index>(parameters.size()), max_camera_parameters));
    camera.width = width;
    camera.height = height;
    const auto reason = camera.model->invalid(camera.parameters);
    if (!reason) return camera;
    add(node, *reason, parameters[0] == 0 ? "a camera_matrix of zeros means: not calibrated" : "");
  }
  return fail(ErrorCode::config, problems);
}

}  // namespace ca2
