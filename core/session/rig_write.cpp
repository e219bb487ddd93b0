#include "core/io/yaml_text.h"
#include "core/session/board_yaml.h"
#include "core/session/pose_yaml.h"
#include "core/session/rig.h"

namespace ca2 {
namespace {

void write_source(std::string& out, const SourceOptions& source) {
  if (source.empty()) return;
  out += "    source: {";
  const char* separator = "";
  for (const auto& [key, value] : source) {
    out += separator + yaml_string(key) + ": " + yaml_string(value);
    separator = ", ";
  }
  out += "}\n";
}

void write_camera(std::string& out, const std::string& name, const RigCamera& camera) {
  out += "  " + yaml_string(name) + ":\n";
  out += "    frame: " + yaml_string(camera.frame.empty() ? name : camera.frame) + "\n";
  if (camera.width > 0) {
    out += "    image_size: [" + std::to_string(camera.width) + ", " + std::to_string(camera.height) + "]\n";
  }
  if (camera.intrinsics) {
    out += "    intrinsics: {model: " + yaml_string(camera.intrinsics->model->name()) +
           ", parameters: " + exact_list(camera.intrinsics->parameters) + "}\n";
  } else {
    out += "    intrinsics: {model: " + yaml_string(camera.model) + "}  # estimated from the views\n";
  }
  write_source(out, camera.source);
}

void write_lidar(std::string& out, const std::string& name, const RigLidar& lidar) {
  out += "  " + yaml_string(name) + ":\n";
  out += "    frame: " + yaml_string(lidar.frame.empty() ? name : lidar.frame) + "\n";
  if (!lidar.metadata.empty()) out += "    metadata: " + yaml_string(lidar.metadata) + "\n";
  if (!lidar.model.empty()) out += "    model: " + yaml_string(lidar.model) + "\n";
  if (!lidar.calibration.empty()) out += "    calibration: " + yaml_string(lidar.calibration) + "\n";
  write_source(out, lidar.source);
}

}  // namespace

std::string write_board(const Board& board) {
  std::string out = "board:\n";
  if (board.type) out += "  type: " + yaml_string(board.type->name()) + "\n";
  out += "  columns: " + std::to_string(board.columns) + "\n";
  out += "  rows: " + std::to_string(board.rows) + "\n";
  out += "  square: " + exact(board.square) + "\n";
  if (board.marker != 0) out += "  marker: " + exact(board.marker) + "\n";
  if (board.spacing != 0) out += "  spacing: " + exact(board.spacing) + "\n";
  if (board.dictionary != Board().dictionary) out += "  dictionary: " + yaml_string(board.dictionary) + "\n";
  if (board.outline) {
    out += "  outline: {width: " + exact(board.outline->width) + ", height: " + exact(board.outline->height) +
           ", center: " + exact_list(board.outline->center) + "}\n";
  }
  return out;
}

std::string write_rig(const Rig& rig) {
  std::string out = "version: 1\n";
  out += write_board(rig.board);
  if (!rig.cameras.empty()) out += "cameras:\n";
  for (const auto& [name, camera] : rig.cameras) write_camera(out, name, camera);
  if (!rig.lidars.empty()) out += "lidars:\n";
  for (const auto& [name, lidar] : rig.lidars) write_lidar(out, name, lidar);
  if (!rig.extrinsics.empty()) out += "extrinsics:\n";
  for (const RigExtrinsic& extrinsic : rig.extrinsics) {
    out += "  - {parent: " + yaml_string(extrinsic.parent) + ", child: " + yaml_string(extrinsic.child) +
           ", translation: " + translation_text(extrinsic.T_parent_child) +
           ", rotation: " + rotation_text(extrinsic.T_parent_child) +
           (extrinsic.fixed ? ", fixed: true" : "") + "}\n";
  }
  return out;
}

}  // namespace ca2
