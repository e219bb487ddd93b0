// ROS camera_info and OpenCV FileStorage files are the same few keys under several spellings; Kalibr's are
// told apart by camera_model and intrinsics.
#include "core/session/intrinsics_file.h"

#include <algorithm>
#include <array>
#include <optional>

#include "core/io/files.h"
#include "core/session/intrinsics_nodes.h"
#include "core/session/rig.h"
#include "core/types/counted.h"

namespace ca2 {
namespace {

constexpr std::size_t file_limit = 1u << 20;  // bytes; such files have 1 or 2 kB

bool is_kalibr(const YAML::Node& node) {
  return node.IsMap() && IntrinsicsNodes::find(node, {"camera_model"}).IsDefined() &&
         IntrinsicsNodes::find(node, {"intrinsics"}).IsDefined();
}

/// fx fy cx cy of a 3x3 matrix that has no skew.
std::vector<double> focal_and_center(IntrinsicsNodes& nodes, const YAML::Node& node) {
  const std::vector<double> K = nodes.numbers(node, "the camera matrix");
  if (!node.IsDefined()) return {};
  if (K.size() != 9) {
    nodes.add(node, "the camera matrix has " + counted(K.size(), "number") + ", not 9");
    return {};
  }
  if (K[1] != 0) nodes.add(node, "the camera matrix has skew, which no model here has");
  if (K[3] != 0 || K[6] != 0 || K[7] != 0 || K[8] != 1) {
    nodes.add(node, "the camera matrix is not [fx 0 cx; 0 fy cy; 0 0 1]");
  }
  return {K[0], K[4], K[2], K[5]};
}

/// K belongs to the full picture: pictures that are binned or cropped need other numbers.
void refuse_binning_and_roi(IntrinsicsNodes& nodes, const YAML::Node& root, int width, int height) {
  for (const char* key : {"binning_x", "binning_y"}) {
    const YAML::Node node = IntrinsicsNodes::find(root, {key});
    if (node.IsDefined() && nodes.number(node, key) > 1) {
      nodes.add(node, std::string(key) + " is over 1", "give the camera_info of the binned picture itself");
    }
  }
  const YAML::Node roi = IntrinsicsNodes::find(root, {"roi"});
  const std::array<std::pair<const char*, int>, 4> whole{
      {{"x_offset", 0}, {"y_offset", 0}, {"width", width}, {"height", height}}};
  for (const auto& [key, value] : whole) {
    const YAML::Node node = IntrinsicsNodes::find(roi, {key});
    if (!node.IsDefined()) continue;
    const double given = nodes.number(node, std::string("roi's ") + key);
    if (given != 0 && given != value) {
      nodes.add(node, "the region of interest is not the whole picture",
                "give the camera_info of the cropped picture itself");
      return;
    }
  }
}

/// Does some key of an OpenCV file say that the lens is a fisheye?
bool says_fisheye(const YAML::Node& root) {
  for (const char* key : {"fisheye_model", "fisheye", "is_fisheye"}) {
    const std::string value = IntrinsicsNodes::text(IntrinsicsNodes::find(root, {key}));
    if (value == "1" || value == "true" || value == "True" || value == "yes") return true;
  }
  for (const char* key : {"distortion_model", "camera_model", "model"}) {
    const std::string value = IntrinsicsNodes::text(IntrinsicsNodes::find(root, {key}));
    if (value == "fisheye" || value == "equidistant" || value == "kannala_brandt") return true;
  }
  return false;
}

/// Our model for the distortion, or nothing and a problem.
std::optional<std::string> distortion_model(IntrinsicsNodes& nodes, const YAML::Node& root, bool opencv,
                                            const YAML::Node& D, std::size_t count) {
  const YAML::Node node = IntrinsicsNodes::find(root, {"distortion_model"});
  const std::string name = IntrinsicsNodes::text(node);
  const std::string given = std::to_string(count) + " distortion coefficients";
  if (name == "equidistant" || name == "fisheye" || (opencv && says_fisheye(root))) {
    if (count == 4) return "kannala_brandt";
    nodes.add(D, given + ", where a fisheye has 4");
    return std::nullopt;
  }
  if (name == "plumb_bob" || name == "rational_polynomial") {
    const bool plain = name == "plumb_bob";
    if (plain && (count == 0 || count == 4 || count == 5)) return "pinhole_radtan";
    if (!plain && count == 8) return "pinhole_rational";
    nodes.add(
        D, given + ", where " + name + " has " + (plain ? "4 or 5" : "8"),
        count == 12 || count == 14 ? "thin prism and tilt are not supported: calibrate without them" : "");
    return std::nullopt;
  }
  if (node.IsDefined()) {
    nodes.add(node, "distortion model '" + name + "' is not supported",
              "plumb_bob, rational_polynomial, equidistant and fisheye are");
    return std::nullopt;
  }
  if (!opencv) {
    nodes.add(root, "'distortion_model' is missing",
              "plumb_bob, rational_polynomial, equidistant or fisheye");
    return std::nullopt;
  }
  if (count == 0 || count == 4 || count == 5) return "pinhole_radtan";
  if (count == 8) return "pinhole_rational";
  nodes.add(
      D, given + ", where 4, 5 and 8 are supported",
      count == 12 || count == 14 ? "thin prism and tilt are not supported: calibrate without them" : "");
  return std::nullopt;
}

/// ROS camera_info (nested or flat) and OpenCV.
Result<Camera> read_matrices(IntrinsicsNodes& nodes, const YAML::Node& root, bool opencv_header) {
  const YAML::Node K_node = nodes.need(root, {"camera_matrix", "cameraMatrix", "Camera_Matrix", "K", "k"});
  const YAML::Node D_node =
      nodes.need(root, {"distortion_coefficients", "distCoeffs", "Distortion_Coefficients", "D", "d"});
  const bool opencv =
      opencv_header || (K_node.IsDefined() && K_node.Tag().find("opencv-matrix") != std::string::npos);
  std::vector<double> parameters = focal_and_center(nodes, K_node);
  const std::vector<double> D = nodes.numbers(D_node, "a distortion coefficient");

  int width = 0, height = 0;
  const YAML::Node size = IntrinsicsNodes::find(root, {"imageSize", "image_size"});
  if (size.IsDefined()) {
    if (size.IsSequence() && size.size() == 2) {
      width = nodes.pixels(size[0], "the picture's width");
      height = nodes.pixels(size[1], "the picture's height");
    } else {
      nodes.add(size, "the image size is not [width, height]");
    }
  } else {
    width = nodes.pixels(nodes.need(root, {"image_width", "image_Width", "width"}), "the picture's width");
    height =
        nodes.pixels(nodes.need(root, {"image_height", "image_Height", "height"}), "the picture's height");
  }
  refuse_binning_and_roi(nodes, root, width, height);

  std::optional<std::string> model;
  if (D_node.IsDefined()) model = distortion_model(nodes, root, opencv, D_node, D.size());
  if (!model || !nodes.problems.empty()) return fail(ErrorCode::config, nodes.problems);
  parameters.insert(parameters.end(), D.begin(), D.end());
  if (D.empty()) parameters.resize(8, 0);
  return nodes.finish(K_node, *model, parameters, width, height);
}

Result<Camera> read_root(IntrinsicsNodes& nodes, const YAML::Node& root, bool opencv_header,
                         const std::string& camera) {
  if (!root.IsMap()) {
    nodes.add(root, "this is not a calibration file: no keys",
              "give a ROS camera_info, a Kalibr camchain or an OpenCV calibration file");
    return fail(ErrorCode::config, nodes.problems);
  }
  std::vector<std::string> names;
  for (const auto& entry : root) {
    if (is_kalibr(entry.second)) names.push_back(IntrinsicsNodes::text(entry.first));
  }
  if (names.empty()) {
    const std::string own = IntrinsicsNodes::text(IntrinsicsNodes::find(root, {"camera_name"}));
    if (!camera.empty() && camera != own) {
      nodes.add(root, "there is no camera '" + camera + "' here: the file is of one camera",
                "leave the name out");
      return fail(ErrorCode::config, nodes.problems);
    }
    return is_kalibr(root) ? read_kalibr_camera(nodes, root) : read_matrices(nodes, root, opencv_header);
  }
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  if (camera.empty() && names.size() > 1) {
    nodes.add(root, "the file has several cameras", "name one of them: " + list);
  } else if (!camera.empty() && std::find(names.begin(), names.end(), camera) == names.end()) {
    nodes.add(root, "there is no camera '" + camera + "' here", "there is: " + list);
  } else {
    const std::string& name = camera.empty() ? names.front() : camera;
    return read_kalibr_camera(nodes, IntrinsicsNodes::find(root, {name.c_str()}));
  }
  return fail(ErrorCode::config, nodes.problems);
}

}  // namespace

Result<Camera> parse_intrinsics(const std::string& text, const std::filesystem::path& file,
                                const std::string& camera) {
  IntrinsicsNodes nodes{file.string(), {}};
  // OpenCV begins with "%YAML:1.0", which is no YAML directive: blanked, so that the line numbers stay.
  std::string yaml = text;
  const bool opencv_header = text.starts_with("%YAML:");
  if (opencv_header) std::fill_n(yaml.begin(), std::min(yaml.find_first_of("\r\n"), yaml.size()), ' ');
  try {
    return read_root(nodes, YAML::Load(yaml), opencv_header, camera);
  } catch (const YAML::Exception& error) {
    std::string where = nodes.file;
    if (error.mark.line >= 0) {
      where += ":" + std::to_string(error.mark.line + 1) + ":" + std::to_string(error.mark.column + 1);
    }
    return fail(ErrorCode::config, where, "this is not YAML: " + error.msg);
  }
}

Result<Camera> read_intrinsics(const std::filesystem::path& file, const std::string& camera) {
  const Result<std::string> text = read_text(file, file_limit);
  if (!text) return fail(text.error());
  return parse_intrinsics(*text, file, camera);
}

}  // namespace ca2
