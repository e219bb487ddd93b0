#include <algorithm>
#include <cstdio>
#include <set>

#include "core/io/files.h"
#include "core/io/yaml_reader.h"
#include "core/session/board_type_hint.h"
#include "core/session/camera_yaml.h"
#include "core/session/intrinsics_file.h"
#include "core/session/pose_yaml.h"
#include "core/session/rig.h"

namespace ca2 {
namespace {

constexpr double max_board_length = 10;  // m
constexpr long long max_board_count = 1000;
constexpr std::size_t max_name_length = 64;

class RigParser {
 public:
  RigParser(const std::filesystem::path& file) : file_(file), reader_(file.string()) {}

  Result<Rig> parse(const YamlNode& root, const std::vector<std::string>& extra_keys) {
    std::vector<std::string_view> known{"version", "board", "cameras", "lidars", "extrinsics"};
    known.insert(known.end(), extra_keys.begin(), extra_keys.end());
    if (root.is_null()) return fail(ErrorCode::config, file_.string(), "is empty");
    if (!reader_.map(&root, "the file", known)) return fail(ErrorCode::config, reader_.problems());
    if (const YamlNode* version = reader_.require(root, "version", "the file")) {
      const auto number = reader_.integer(version, 0, 1000000);
      if (number && *number != 1) {
        reader_.problem(*version,
                        "version " + version->text + " is not known to this program, which reads 1");
      }
    }
    board(reader_.require(root, "board", "the file"));
    if (const YamlNode* cameras = root.find("cameras"); reader_.map(cameras, "cameras")) {
      for (const YamlNode& node : cameras->items) camera(node);
    }
    if (const YamlNode* lidars = root.find("lidars"); reader_.map(lidars, "lidars")) {
      for (const YamlNode& node : lidars->items) lidar(node);
    }
    if (names_.empty()) reader_.problem(root, "there are neither cameras nor lidars");
    if (const YamlNode* list = root.find("extrinsics"); reader_.sequence(list, "extrinsics")) {
      for (const YamlNode& node : list->items) extrinsic(node);
    }
    if (!reader_.problems().empty()) return fail(ErrorCode::config, reader_.problems());
    return std::move(rig_);
  }

 private:
  void board(const YamlNode* node) {
    if (!reader_.map(node, "board",
                     {"type", "columns", "rows", "square", "marker", "spacing", "dictionary", "outline"})) {
      return;
    }
    // A board with half its numbers would only be judged wrongly: its type looks at it when all were read.
    const std::size_t problems_before = reader_.problems().size();
    Board& board = rig_.board;
    const YamlNode* type = reader_.require(*node, "type", "board");
    if (const auto name = reader_.text(type)) {
      board.type = find_board_type(*name);
      if (!board.type) {
        reader_.problem(*type, "there is no board type '" + *name + "'", board_type_hint(*name));
      }
    }
    const auto count = [&](const char* key) {
      return static_cast<int>(
          reader_.integer(reader_.require(*node, key, "board"), 1, max_board_count).value_or(0));
    };
    board.columns = count("columns");
    board.rows = count("rows");
    board.square =
        reader_.length(reader_.require(*node, "square", "board"), 1e-4, max_board_length).value_or(0);
    board.marker = reader_.length(node->find("marker"), 1e-4, max_board_length).value_or(0);
    board.spacing = reader_.number(node->find("spacing"), 0, 100).value_or(0);
    board.dictionary = reader_.text(node->find("dictionary")).value_or(board.dictionary);
    outline(node->find("outline"));
    if (!board.type || reader_.problems().size() != problems_before) return;
    for (std::string& wrong : board.type->invalid(board)) reader_.problem(*node, std::move(wrong));
    if (board.outline && reader_.problems().size() == problems_before) holds_pattern(*node->find("outline"));
  }

  /// A plate that the print does not fit on: mistaken sides, or squares counted for corners. Sheets may be
  /// cut through the outer squares.
  void holds_pattern(const YamlNode& node) {
    const Board& board = rig_.board;
    const Eigen::Vector2d pattern = board.type->pattern_size(board);
    const Eigen::Vector2d plate(board.outline->width, board.outline->height);
    const Eigen::Vector2d beyond = 0.5 * (pattern - plate) + board.outline->center.cwiseAbs();
    if (beyond.maxCoeff() <= 0.5 * board.square) return;
    const auto size = [](const Eigen::Vector2d& sides) {
      char text[64];
      std::snprintf(text, sizeof text, "%.3f x %.3f m", sides.x(), sides.y());
      return std::string(text);
    };
    reader_.problem(node,
                    "the print, " + size(pattern) + ", does not fit on this plate of " + size(plate) +
                        (board.outline->center.isZero() ? "" : " with its centre"),
                    "width is along the columns, height along the rows; center is how far the plate's lies "
                    "from the print's; are columns and rows what docs/boards.md says?");
  }

  void outline(const YamlNode* node) {
    if (!reader_.map(node, "outline", {"width", "height", "center"})) return;
    const auto width = reader_.length(reader_.require(*node, "width", "outline"), 1e-3, max_board_length);
    const auto height = reader_.length(reader_.require(*node, "height", "outline"), 1e-3, max_board_length);
    const YamlNode* center_node = node->find("center");
    const auto center = reader_.numbers(center_node, 2, max_board_length);
    if (!width || !height || (center_node && !center)) return;
    Outline outline{*width, *height, Eigen::Vector2d::Zero()};
    if (center) outline.center = Eigen::Vector2d(center->data());
    rig_.board.outline = outline;
  }

  /// Sensor names become file names and parts of messages.
  bool sensor_name(const YamlNode& node) {
    if (!valid_sensor_name(node.key)) {
      reader_.key_problem(node, "a sensor's name must be 1 to " + std::to_string(max_name_length) +
                                    " letters, digits, '_' and '-'");
      return false;
    }
    if (!names_.insert(node.key).second) {
      reader_.key_problem(node, "there is a camera named '" + node.key + "' already",
                          "names are unique over cameras and lidars");
      return false;
    }
    return true;
  }

  void camera(const YamlNode& node) {
    const bool named = sensor_name(node);
    if (!reader_.map(&node, "a camera", {"frame", "image_size", "intrinsics", "file", "camera", "source"})) {
      return;
    }
    RigCamera camera;
    camera.frame = reader_.text(node.find("frame")).value_or(node.key);
    image_size(node.find("image_size"), camera);
    const YamlNode* intrinsics_node = node.find("intrinsics");
    if (intrinsics_node && node.find("file")) {
      reader_.problem(*node.find("file"), "the camera has both 'file' and 'intrinsics'", "keep one of them");
    } else if (intrinsics_node) {
      intrinsics(*intrinsics_node, camera);
    } else {
      intrinsics_file(node, camera);
    }
    source(node.find("source"), camera.source);
    if (named) rig_.cameras.emplace(node.key, std::move(camera));
  }

  void image_size(const YamlNode* node, RigCamera& camera) {
    if (!node) return;
    if (!node->is_sequence() || node->items.size() != 2) {
      reader_.problem(*node, "image_size must be [width, height] in pixels");
      return;
    }
    const auto width = reader_.integer(&node->items[0], 1, max_image_side);
    const auto height = reader_.integer(&node->items[1], 1, max_image_side);
    if (!width || !height) return;
    camera.width = static_cast<int>(*width);
    camera.height = static_cast<int>(*height);
  }

  void intrinsics(const YamlNode& node, RigCamera& camera) {
    if (!reader_.map(&node, "intrinsics", {"model", "parameters", "file", "camera"})) return;
    if (node.find("file")) {
      for (const char* key : {"model", "parameters"}) {
        if (const YamlNode* extra = node.find(key)) {
          reader_.key_problem(*extra, "'" + std::string(key) + "' beside 'file'", "keep one of them");
        }
      }
      intrinsics_file(node, camera);
      return;
    }
    if (const YamlNode* extra = node.find("camera")) reader_.key_problem(*extra, "'camera' needs a 'file'");
    const CameraModel* model = read_model(reader_, reader_.require(node, "model", "intrinsics"));
    if (!model) return;
    camera.model = model->name();
    const YamlNode* parameters_node = node.find("parameters");
    if (!parameters_node) return;  // to be estimated with this model
    if (const auto parameters = read_parameters(reader_, parameters_node, *model)) {
      camera.intrinsics = Camera{model, *parameters, camera.width, camera.height};
    }
  }

  /// `file` and `camera` of a node.
  void intrinsics_file(const YamlNode& node, RigCamera& camera) {
    const YamlNode* file_node = node.find("file");
    const YamlNode* choice_node = node.find("camera");
    if (choice_node && !file_node) reader_.key_problem(*choice_node, "'camera' needs a 'file'");
    const auto name = reader_.text(file_node);
    if (!name) return;
    const auto read = read_intrinsics(file_.parent_path() / *name, reader_.text(choice_node).value_or(""));
    if (!read) {
      reader_.problem(*file_node, "the camera's file cannot be used: see the next lines");
      for (const Problem& problem : read.error().problems) reader_.problem(problem);
      return;
    }
    if (camera.width != 0 && read->width != 0 &&
        (camera.width != read->width || camera.height != read->height)) {
      reader_.problem(*file_node, "the file is for pictures of " + std::to_string(read->width) + " x " +
                                      std::to_string(read->height) + ", image_size says " +
                                      std::to_string(camera.width) + " x " + std::to_string(camera.height));
      return;
    }
    if (camera.width == 0) {
      camera.width = read->width;
      camera.height = read->height;
    }
    camera.model = read->model->name();
    camera.intrinsics = Camera{read->model, read->parameters, camera.width, camera.height};
  }

  void lidar(const YamlNode& node) {
    const bool named = sensor_name(node);
    if (!reader_.map(&node, "a lidar", {"frame", "metadata", "model", "calibration", "source"})) return;
    RigLidar lidar;
    lidar.frame = reader_.text(node.find("frame")).value_or(node.key);
    lidar.metadata = reader_.text(node.find("metadata")).value_or("");
    lidar.model = reader_.text(node.find("model")).value_or("");
    lidar.calibration = reader_.text(node.find("calibration")).value_or("");
    source(node.find("source"), lidar.source);
    if (named) rig_.lidars.emplace(node.key, std::move(lidar));
  }

  /// Which keys a driver knows is for the driver to judge.
  void source(const YamlNode* node, SourceOptions& options) {
    if (!reader_.map(node, "source")) return;
    for (const YamlNode& item : node->items) {
      if (item.is_scalar()) {
        options.emplace(item.key, item.text);
      } else {
        reader_.problem(item, "'" + item.key + "' must be a single value");
      }
    }
  }

  void extrinsic(const YamlNode& node) {
    if (!reader_.map(&node, "an extrinsic", {"parent", "child", "translation", "rotation", "fixed"})) return;
    RigExtrinsic extrinsic;
    const auto sensor = [&](const char* key) -> std::string {
      const YamlNode* name_node = reader_.require(node, key, "the extrinsic");
      const auto name = reader_.text(name_node);
      if (!name) return {};
      if (names_.count(*name)) return *name;
      const std::vector<std::string_view> known(names_.begin(), names_.end());
      reader_.problem(*name_node, "there is no sensor '" + *name + "'", suggest(*name, known));
      return {};
    };
    extrinsic.parent = sensor("parent");
    extrinsic.child = sensor("child");
    const auto pose = read_pose(reader_, node, "the extrinsic");
    extrinsic.fixed = reader_.boolean(node.find("fixed")).value_or(false);
    if (extrinsic.parent.empty() || extrinsic.child.empty() || !pose) return;
    extrinsic.T_parent_child = *pose;
    if (extrinsic.parent == extrinsic.child) {
      reader_.problem(node, "parent and child are the same sensor");
      return;
    }
    if (!pairs_.insert(std::minmax(extrinsic.parent, extrinsic.child)).second) {
      reader_.problem(
          node, "there is an extrinsic between " + extrinsic.parent + " and " + extrinsic.child + " already");
      return;
    }
    rig_.extrinsics.push_back(std::move(extrinsic));
  }

  const std::filesystem::path& file_;
  YamlReader reader_;
  std::set<std::string> names_;                          // of all sensors
  std::set<std::pair<std::string, std::string>> pairs_;  // of extrinsics, either way round
  Rig rig_;
};

}  // namespace

bool valid_sensor_name(std::string_view name) {
  const auto allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  };
  return !name.empty() && name.size() <= max_name_length && std::all_of(name.begin(), name.end(), allowed);
}

Result<Rig> parse_rig(const std::string& text, const std::filesystem::path& file,
                      const std::vector<std::string>& extra_keys) {
  const Result<YamlNode> root = parse_yaml(text, file.string());
  if (!root) return fail(root.error());
  return RigParser(file).parse(*root, extra_keys);
}

Result<Rig> read_rig(const std::filesystem::path& file, const std::vector<std::string>& extra_keys) {
  Result<std::string> text = read_text(file, max_yaml_bytes);
  if (!text) {
    Error error = text.error();
    if (error.code == ErrorCode::data) error.code = ErrorCode::config;
    return fail(std::move(error));
  }
  return parse_rig(*text, file, extra_keys);
}

}  // namespace ca2
