#include "tools/sim/truth_file.h"

#include <cmath>
#include <limits>

#include "core/io/files.h"
#include "core/io/yaml_reader.h"
#include "core/io/yaml_text.h"
#include "core/session/pose_yaml.h"

namespace ca2 {
namespace {

std::string pose_text(const Pose& pose) {
  return "translation: " + translation_text(pose) + ", rotation: " + rotation_text(pose);
}

const char* kind_text(WrongObject kind) {
  switch (kind) {
    case WrongObject::panel:
      return "panel";
    case WrongObject::moved:
      return "moved";
    case WrongObject::none:
      break;
  }
  return "none";
}

}  // namespace

std::string truth_text(const Scenario& scenario, const std::vector<ViewTruth>& views) {
  std::string text = "version: 1\nscenario: " + yaml_string(scenario.name) +
                     "\nseed: " + std::to_string(scenario.seed) + "\n";
  text += "# T_parent_child, m\ntransforms:\n";
  for (const auto& [camera_name, camera] : scenario.cameras) {
    for (const auto& [lidar_name, lidar] : scenario.lidars) {
      text += "  - {parent: " + camera_name + ", child: " + lidar_name + ", " +
              pose_text(camera.T_rig_camera.inverse() * lidar.T_rig_lidar) + "}\n";
    }
    for (const auto& [other_name, other] : scenario.cameras) {
      if (other_name <= camera_name) continue;
      text += "  - {parent: " + camera_name + ", child: " + other_name + ", " +
              pose_text(camera.T_rig_camera.inverse() * other.T_rig_camera) + "}\n";
    }
  }
  if (!scenario.cameras.empty()) text += "cameras:\n";
  for (const auto& [name, camera] : scenario.cameras) {
    text += "  " + name + ": {model: " + std::string(camera.camera.model->name()) +
            ", parameters: " + exact_list(camera.camera.parameters) + ", image_size: [" +
            std::to_string(camera.camera.width) + ", " + std::to_string(camera.camera.height) + "]}\n";
  }
  if (!scenario.lidars.empty()) text += "lidars:\n";
  for (const auto& [name, lidar] : scenario.lidars) {
    text += "  " + name + ": {range_bias: " + exact(lidar.noise.range_bias) +
            ", range_sigma: " + exact(lidar.noise.range_sigma) +
            ", reflectivity_bias: " + exact(lidar.noise.reflectivity_bias) + "}\n";
  }
  if (views.empty()) return text;
  text += "# T_sensor_board; a wrong object is not what the board's pose says\nviews:\n";
  for (const ViewTruth& view : views) {
    text += "  - id: " + std::to_string(view.id) + "\n    wrong_object: " + kind_text(view.wrong_object) +
            "\n    board:\n";
    for (const auto& [name, T_sensor_board] : view.T_sensor_board) {
      text += "      " + name + ": {" + pose_text(T_sensor_board) + "}\n";
    }
  }
  return text;
}

std::string holds_text(const Scenario& scenario, const std::vector<TrueHold>& holds, std::int64_t start) {
  const auto stamp = [&](double time) { return std::to_string(start + std::llround(1e9 * time)); };
  std::string text =
      "# ns UTC; T_sensor_board, mean of the tremor, of the sensors that see the board\nholds:\n";
  for (const TrueHold& hold : holds) {
    text += "  - id: " + std::to_string(hold.id) + "\n    from: " + stamp(hold.from) +
            "\n    to: " + stamp(hold.to) + "\n    board:\n";
    for (const std::string& name : hold.sensors) {
      text += "      " + name + ": {" + pose_text(scenario.T_rig_sensor(name).inverse() * hold.T_rig_board) +
              "}\n";
    }
  }
  return text;
}

Result<std::vector<RecordedHold>> read_true_holds(const std::filesystem::path& file) {
  const Result<std::string> text = read_text(file, max_yaml_bytes);
  if (!text) return fail(text.error());
  const Result<YamlNode> root = parse_yaml(*text, file.string());
  if (!root) return fail(root.error());
  YamlReader reader(file.string());
  std::vector<RecordedHold> holds;
  const YamlNode* list =
      reader.map(&*root, "the truth") ? reader.require(*root, "holds", "the truth") : nullptr;
  constexpr long long most = std::numeric_limits<long long>::max();
  if (list && reader.sequence(list, "'holds'")) {
    for (const YamlNode& node : list->items) {
      if (!reader.map(&node, "a hold", {"id", "from", "to", "board"})) continue;
      RecordedHold hold;
      const auto id = reader.integer(reader.require(node, "id", "a hold"), 0, 1'000'000);
      const auto from = reader.integer(reader.require(node, "from", "a hold"), 0, most);
      const auto to = reader.integer(reader.require(node, "to", "a hold"), 0, most);
      const YamlNode* board = reader.require(node, "board", "a hold");
      if (!id || !from || !to || !reader.map(board, "'board'")) continue;
      hold.id = static_cast<int>(*id);
      hold.from = *from;
      hold.to = *to;
      for (const YamlNode& item : board->items) {
        if (const auto pose = read_pose(reader, item, "a pose")) hold.T_sensor_board[item.key] = *pose;
      }
      holds.push_back(std::move(hold));
    }
  }
  if (!reader.problems().empty()) return fail(ErrorCode::data, reader.problems());
  return holds;
}

Result<std::vector<TrueTransform>> read_true_transforms(const std::filesystem::path& file) {
  const Result<std::string> text = read_text(file, max_yaml_bytes);
  if (!text) return fail(text.error());
  const Result<YamlNode> root = parse_yaml(*text, file.string());
  if (!root) return fail(root.error());
  YamlReader reader(file.string());
  std::vector<TrueTransform> transforms;
  const YamlNode* list =
      reader.map(&*root, "the truth") ? reader.require(*root, "transforms", "the truth") : nullptr;
  if (list && reader.sequence(list, "'transforms'")) {
    for (const YamlNode& node : list->items) {
      if (!reader.map(&node, "a transform", {"parent", "child", "translation", "rotation"})) continue;
      const auto parent = reader.text(reader.require(node, "parent", "a transform"));
      const auto child = reader.text(reader.require(node, "child", "a transform"));
      const auto pose = read_pose(reader, node, "a transform");
      if (parent && child && pose) transforms.push_back({*parent, *child, *pose});
    }
  }
  if (!reader.problems().empty()) return fail(ErrorCode::data, reader.problems());
  return transforms;
}

}  // namespace ca2
