#include <charconv>
#include <cmath>
#include <limits>

#include "core/io/files.h"
#include "core/io/yaml_reader.h"
#include "core/session/calibration.h"
#include "core/session/camera_yaml.h"
#include "core/session/pose_yaml.h"

namespace ca2 {
namespace {

constexpr double per_milli = 1000;  // m to mm, rad to mrad
constexpr double huge_number = 1e12;

class CalibrationParser {
 public:
  explicit CalibrationParser(const std::string& file) : file_(file), reader_(file) {}

  Result<Calibration> parse(const YamlNode& root) {
    if (root.is_null()) return fail(ErrorCode::data, file_, "is empty");
    if (reader_.map(&root, "the result",
                    {"version", "software", "method", "transforms", "cameras", "lidars", "print",
                     "observability", "validation", "views", "notes", "inputs"})) {
      const YamlNode* version = reader_.require(root, "version", "the result");
      const auto number = reader_.integer(version, 0, 1000000);
      if (number && *number != 1) {
        reader_.problem(*version,
                        "version " + version->text + " is not known to this program, which reads 1");
      }
      result_.software = words(root, "software");
      result_.method = reader_.text(reader_.require(root, "method", "the result")).value_or("");
      for_list(reader_.require(root, "transforms", "the result"), [&](const YamlNode& n) { transform(n); });
      for_map(root.find("cameras"), [&](const YamlNode& n) { camera(n); });
      for_map(root.find("lidars"), [&](const YamlNode& n) { lidar(n); });
      if (const YamlNode* node = root.find("print")) print(*node);
      observability(root.find("observability"));
      validation(root.find("validation"));
      for_list(root.find("views"), [&](const YamlNode& n) { view(n); });
      for_list(root.find("notes"),
               [&](const YamlNode& n) { result_.notes.push_back(reader_.text(&n).value_or("")); });
      if (const YamlNode* node = root.find("inputs")) inputs(*node);
    }
    if (!reader_.problems().empty()) return fail(ErrorCode::data, reader_.problems());
    return std::move(result_);
  }

 private:
  template <class Read>
  void for_list(const YamlNode* list, Read read) {
    if (!list || !reader_.sequence(list, "'" + list->key + "'")) return;
    for (const YamlNode& node : list->items) read(node);
  }
  template <class Read>
  void for_map(const YamlNode* map, Read read) {
    if (!map || !reader_.map(map, "'" + map->key + "'")) return;
    for (const YamlNode& node : map->items) read(node);
  }

  /// A figure that may be "not known": .nan. 0 where it is absent.
  double figure(const YamlNode& map, std::string_view key) {
    const YamlNode* node = map.find(key);
    if (node) {
      const auto value = yaml_number(*node);
      if (value && !std::isfinite(*value)) return *value;
    }
    return reader_.number(node, -huge_number, huge_number).value_or(0);
  }

  /// A text that may be empty.
  std::string words(const YamlNode& map, std::string_view key) {
    const YamlNode* node = map.find(key);
    if (!node || (node->is_scalar() && node->text.empty())) return {};
    return reader_.text(node).value_or("");
  }

  bool flag(const YamlNode& map, std::string_view key) {
    return reader_.boolean(map.find(key)).value_or(false);
  }

  void transform(const YamlNode& node) {
    if (!reader_.map(&node, "a transform",
                     {"parent", "child", "parent_frame", "child_frame", "translation", "rotation",
                      "covariance", "sigma_translation_mm", "sigma_rotation_mrad"})) {
      return;
    }
    CalibratedTransform t;
    t.parent = reader_.text(reader_.require(node, "parent", "the transform")).value_or("");
    t.child = reader_.text(reader_.require(node, "child", "the transform")).value_or("");
    t.parent_frame = reader_.text(node.find("parent_frame")).value_or(t.parent);
    t.child_frame = reader_.text(node.find("child_frame")).value_or(t.child);
    const auto pose = read_pose(reader_, node, "the transform");
    const YamlNode* covariance_node = reader_.require(node, "covariance", "the transform");
    const auto covariance = reader_.numbers(covariance_node, 36, huge_number);
    if (!pose || !covariance) return;
    t.T_parent_child = *pose;
    t.covariance = Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(covariance->data());
    const double scale = t.covariance.cwiseAbs().maxCoeff();
    if (t.covariance.diagonal().minCoeff() < 0 ||
        (t.covariance - t.covariance.transpose()).cwiseAbs().maxCoeff() > 1e-9 * scale) {
      reader_.problem(*covariance_node,
                      "this is no covariance: it must be symmetric, its diagonal not negative");
      return;
    }
    result_.transforms.push_back(std::move(t));
  }

  void camera(const YamlNode& node) {
    if (!reader_.map(&node, "a camera", {"model", "image_size", "parameters", "estimated", "sigma"})) return;
    CalibratedCamera calibrated;
    const CameraModel* model = read_model(reader_, reader_.require(node, "model", "the camera"));
    const YamlNode* parameters_node = reader_.require(node, "parameters", "the camera");
    const auto size = reader_.numbers(node.find("image_size"), 2, 1e5);
    calibrated.estimated = flag(node, "estimated");
    if (const auto sigma = reader_.numbers(node.find("sigma"), 0, huge_number)) calibrated.sigma = *sigma;
    if (!model) return;
    const auto parameters = read_parameters(reader_, parameters_node, *model);
    if (!parameters) return;
    calibrated.camera = Camera{model, *parameters, 0, 0};
    if (size) {
      calibrated.camera.width = static_cast<int>((*size)[0]);
      calibrated.camera.height = static_cast<int>((*size)[1]);
    }
    result_.cameras.emplace(node.key, std::move(calibrated));
  }

  void lidar(const YamlNode& node) {
    if (!reader_.map(&node, "a lidar", {"range_bias", "range_bias_sigma", "range_sigma", "estimated"}))
      return;
    result_.lidars[node.key] = {figure(node, "range_bias"), figure(node, "range_bias_sigma"),
                                figure(node, "range_sigma"), flag(node, "estimated")};
  }

  void print(const YamlNode& node) {
    if (!reader_.map(&node, "print", {"stretch", "sigma"})) return;
    const auto stretch = reader_.numbers(reader_.require(node, "stretch", "print"), 2, 1);
    const auto sigma = reader_.numbers(reader_.require(node, "sigma", "print"), 2, huge_number);
    if (!stretch || !sigma) return;
    result_.print = {{(*stretch)[0], (*stretch)[1]}, {(*sigma)[0], (*sigma)[1]}, true};
  }

  void observability(const YamlNode* node) {
    if (!reader_.map(node, "observability", {"verdict", "weakest_direction", "condition"})) return;
    result_.observability = {words(*node, "verdict"), words(*node, "weakest_direction"),
                             figure(*node, "condition")};
  }

  void validation(const YamlNode* node) {
    if (!reader_.map(node, "validation",
                     {"leave_one_out", "outline_offset_mm", "reprojection_rms_px", "range_rms_mm"})) {
      return;
    }
    Validation& v = result_.validation;
    const YamlNode* left_out = node->find("leave_one_out");
    if (reader_.map(left_out, "leave_one_out", {"translation_mm", "rotation_mrad"})) {
      v.leave_one_out_translation = figure(*left_out, "translation_mm") / per_milli;
      v.leave_one_out_rotation = figure(*left_out, "rotation_mrad") / per_milli;
    }
    const YamlNode* offset = node->find("outline_offset_mm");
    if (offset && !offset->is_null()) v.outline_offset = figure(*node, "outline_offset_mm") / per_milli;
    v.reprojection_rms = figure(*node, "reprojection_rms_px");
    v.range_rms = figure(*node, "range_rms_mm") / per_milli;
  }

  void view(const YamlNode& node) {
    if (!reader_.map(&node, "a view", {"id", "used", "reason", "reprojection_rms_px", "plane_rms_mm"}))
      return;
    const auto id =
        reader_.integer(reader_.require(node, "id", "the view"), 0, std::numeric_limits<int>::max());
    result_.views.push_back({static_cast<int>(id.value_or(0)), flag(node, "used"), words(node, "reason"),
                             figure(node, "reprojection_rms_px"), figure(node, "plane_rms_mm") / per_milli});
  }

  std::map<std::string, std::string> digests(const YamlNode& node) {
    std::map<std::string, std::string> read;
    for_map(&node, [&](const YamlNode& n) { read[n.key] = reader_.text(&n).value_or(""); });
    return read;
  }

  void inputs(const YamlNode& node) {
    if (!reader_.map(&node, "inputs", {"rig", "views"})) return;
    const YamlNode* rig = reader_.require(node, "rig", "inputs");
    const YamlNode* views = reader_.require(node, "views", "inputs");
    if (!rig || !views) return;
    CalibrationInputs& inputs = result_.inputs.emplace();
    inputs.rig = digests(*rig);
    for_map(views, [&](const YamlNode& view) {
      int id = 0;
      const char* end = view.key.data() + view.key.size();
      if (const auto read = std::from_chars(view.key.data(), end, id);
          read.ec != std::errc() || read.ptr != end) {
        return reader_.key_problem(view, "'" + view.key + "' is no view's number", {});
      }
      inputs.views[id] = digests(view);
    });
  }

  const std::string& file_;
  YamlReader reader_;
  Calibration result_;
};

}  // namespace

Result<Calibration> parse_calibration(const std::string& text, const std::string& name) {
  const Result<YamlNode> root = parse_yaml(text, name, ErrorCode::data);
  if (!root) return fail(root.error());
  return CalibrationParser(name).parse(*root);
}

Result<Calibration> read_calibration(const std::filesystem::path& file) {
  const Result<std::string> text = read_text(file, max_yaml_bytes);
  if (!text) return fail(text.error());
  return parse_calibration(*text, file.string());
}

}  // namespace ca2
