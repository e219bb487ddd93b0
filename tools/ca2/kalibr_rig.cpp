#include "tools/ca2/kalibr_rig.h"

#include <Eigen/LU>
#include <cmath>

#include "core/geometry/so3.h"
#include "core/io/files.h"
#include "core/io/yaml_reader.h"
#include "core/session/board_type_hint.h"

namespace ca2 {
namespace {

namespace fs = std::filesystem;

constexpr double largest_length = 100;  // m

Result<YamlNode> read_tree(const fs::path& file) {
  const Result<std::string> text = read_text(file);
  if (!text) return fail(text.error());
  return parse_yaml(*text, file.string());
}

/// T_cn_cnm1, by rows; nothing where it is no rigid transform.
std::optional<Pose> rigid(YamlReader& reader, const YamlNode& node) {
  Eigen::Matrix4d m;
  bool good = node.is_sequence() && node.items.size() == 4;
  for (int i = 0; good && i < 4; ++i) {
    const auto row = reader.numbers(&node.items[static_cast<std::size_t>(i)], 4, largest_length);
    good = row.has_value();
    if (good) m.row(i) = Eigen::RowVector4d(row->data());
  }
  const Eigen::Matrix3d R = m.topLeftCorner<3, 3>();
  if (!good || (R * R.transpose() - Eigen::Matrix3d::Identity()).norm() > 1e-3 || R.determinant() < 0) {
    reader.problem(node, "T_cn_cnm1 is no rigid transform of 4 x 4 numbers");
    return std::nullopt;
  }
  return Pose{nearest_rotation(R), m.topRightCorner<3, 1>()};
}

}  // namespace

Result<Board> read_kalibr_target(const fs::path& file) {
  const Result<YamlNode> root = read_tree(file);
  if (!root) return fail(root.error());
  YamlReader reader(file.string());
  const auto kind =
      root->is_map() ? reader.text(reader.require(*root, "target_type", "target")) : std::nullopt;
  if (!kind) {
    if (!root->is_map()) reader.problem(*root, "is no target of Kalibr's");
    return fail(ErrorCode::config, reader.problems());
  }
  Board board;
  const auto count = [&](const char* key) {
    return static_cast<int>(reader.integer(reader.require(*root, key, "target"), 1, 1000).value_or(0));
  };
  const auto length = [&](const char* key) {
    return reader.number(reader.require(*root, key, "target"), 1e-4, largest_length).value_or(0);
  };
  if (*kind == "aprilgrid") {
    board.columns = count("tagCols");
    board.rows = count("tagRows");
    board.square = length("tagSize");
    board.spacing = length("tagSpacing");
    if (const YamlNode* offset = root->find("codeOffset"); reader.integer(offset, 0, 1000).value_or(0) != 0) {
      reader.problem(*offset, "tags that do not begin with id 0 are not read",
                     "print the board with ca2 board");
    }
  } else if (*kind == "checkerboard") {
    board.columns = count("targetCols");
    board.rows = count("targetRows");
    board.square = length("colSpacingMeters");
    if (std::abs(length("rowSpacingMeters") - board.square) > 1e-6) {
      reader.problem(*root, "rowSpacingMeters differs from colSpacingMeters", "only square squares are read");
    }
  } else {
    reader.problem(*root->find("target_type"), "a '" + *kind + "' is not read",
                   "Kalibr's aprilgrid and checkerboard are");
  }
  board.type = find_board_type(*kind);
  if (reader.problems().empty() && !board.type) {
    reader.problem(*root, "there is no board type '" + *kind + "'", board_type_hint(*kind));
  }
  if (reader.problems().empty()) {
    for (std::string& wrong : board.type->invalid(board)) reader.problem(*root, std::move(wrong));
  }
  if (!reader.problems().empty()) return fail(ErrorCode::config, reader.problems());
  return board;
}

Result<Rig> kalibr_rig(const fs::path& target, const fs::path& camchain,
                       const std::vector<std::string>& lidars) {
  Rig rig;
  const Result<Board> board = read_kalibr_target(target);
  if (!board) return fail(board.error());
  rig.board = *board;
  const Result<YamlNode> root = read_tree(camchain);
  if (!root) return fail(root.error());
  YamlReader reader(camchain.string());
  std::string before;
  if (reader.map(&*root, "camchain")) {
    for (const YamlNode& node : root->items) {
      if (node.key.rfind("cam", 0) != 0 || !node.is_map() || !valid_sensor_name(node.key)) continue;
      const Result<Camera> camera = read_intrinsics(camchain, node.key);
      if (!camera) {
        for (const Problem& problem : camera.error().problems) reader.problem(problem);
        continue;
      }
      RigCamera& entry = rig.cameras[node.key];
      entry.frame = node.key;
      entry.width = camera->width;
      entry.height = camera->height;
      entry.intrinsics = *camera;
      const YamlNode* link = node.find("T_cn_cnm1");
      if (link && !before.empty()) {
        if (const auto T = rigid(reader, *link)) rig.extrinsics.push_back({node.key, before, *T, false});
      }
      before = node.key;
    }
    if (rig.cameras.empty() && reader.problems().empty())
      reader.problem(*root, "has no cameras cam0, cam1, ...");
  }
  for (const std::string& lidar : lidars) {
    if (!valid_sensor_name(lidar) || rig.cameras.count(lidar) ||
        !rig.lidars.emplace(lidar, RigLidar{}).second) {
      reader.problem(
          {"--lidar " + lidar, "is no name for a LiDAR of this rig", "letters, digits, _ and -, each once"});
      continue;
    }
    rig.lidars[lidar].frame = lidar;
  }
  if (!reader.problems().empty()) return fail(ErrorCode::config, reader.problems());
  return rig;
}

}  // namespace ca2
