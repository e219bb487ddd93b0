#include "core/export/selection.h"

#include <algorithm>

#include "core/types/counted.h"
#include "core/types/text.h"

namespace ca2 {
namespace {

/// Text of a directory's name: no line breaks, and not the end of an XML comment.
std::string safe(std::string text) {
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20) c = ' ';
  }
  for (std::size_t at; (at = text.find("--")) != std::string::npos;) text.replace(at, 2, "- -");
  return text;
}

}  // namespace

Result<std::vector<ExportTransform>> select_tree(const ExportRequest& request, const std::string& root,
                                                 const std::vector<std::string>& children) {
  FrameGraph frames = request.frames;
  const Result<std::string> parent = frames.find(request.parent.empty() ? root : request.parent);
  if (!parent) return fail(parent.error());
  std::vector<ExportTransform> transforms;
  for (const std::string& name : request.children.empty() ? children : request.children) {
    const Result<std::string> child = frames.find(name);
    if (!child) return fail(child.error());
    if (*child == *parent) {
      if (request.children.empty()) continue;
      return fail(ErrorCode::usage, "", "'" + name + "' is both parent and child", "name another --parent");
    }
    const Result<Connection> connection = frames.between(*parent, *child);
    if (!connection) return fail(connection.error());
    transforms.push_back({*parent, *child, *connection});
  }
  if (transforms.empty())
    return fail(ErrorCode::data, "", "the result has no transform to export", "solve the session again");
  return transforms;
}

Result<std::vector<ExportTransform>> select_default_tree(const ExportRequest& request) {
  std::vector<std::string> sensors;
  for (const auto& [name, camera] : request.calibration.cameras) sensors.push_back(name);
  const std::vector<std::string> lidars = lidar_names(request.calibration);
  sensors.insert(sensors.end(), lidars.begin(), lidars.end());
  if (sensors.size() < 2)
    return fail(ErrorCode::data, "", "the result has no transform", "solve the session again");
  return select_tree(request, sensors.front(), sensors);
}

std::vector<std::string> lidar_names(const Calibration& calibration) {
  std::vector<std::string> names;
  for (const CalibratedTransform& t : calibration.transforms) {
    for (const std::string& name : {t.parent, t.child}) {
      if (!calibration.cameras.count(name)) names.push_back(name);
    }
  }
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

Result<std::vector<ExportCamera>> select_cameras(const ExportRequest& request, const std::string& format) {
  std::vector<ExportCamera> cameras;
  for (const auto& [name, calibrated] : request.calibration.cameras) {
    const std::string& frame = request.frames.frame_of(name);
    if (!request.parent.empty() && request.parent != name && request.parent != frame) continue;
    if (calibrated.camera.width <= 0 || calibrated.camera.height <= 0) {
      return inexpressible(format, "camera '" + name + "' has no picture size, which the format needs",
                           "give image_size in session.yaml and solve again");
    }
    cameras.push_back({name, &calibrated, {}});
    const std::vector<std::string> lidars = lidar_names(request.calibration);
    if (lidars.empty() && request.children.empty()) continue;  // calibrated alone
    ExportRequest of_camera = request;
    of_camera.parent = name;
    auto transforms = select_tree(of_camera, name, lidars);
    if (!transforms) return fail(transforms.error());
    cameras.back().transforms = std::move(*transforms);
  }
  if (cameras.empty()) {
    return inexpressible(format, "'" + request.parent + "' is no camera of this calibration",
                         "its files are of cameras: --parent names one, or leave it out");
  }
  return cameras;
}

Result<void> check_frame_names(const std::vector<ExportTransform>& transforms) {
  std::vector<Problem> problems;
  for (const ExportTransform& t : transforms) {
    for (const std::string& name : {t.parent, t.child}) {
      const auto plain = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
               c == '-' || c == '.' || c == '/';
      };
      if (!name.empty() && name[0] != '/' && std::all_of(name.begin(), name.end(), plain)) continue;
      problems.push_back({"", "the frame name '" + name + "' cannot be in this format",
                          "use letters, digits and _ - . / and no / in front"});
    }
  }
  if (!problems.empty()) return fail(ErrorCode::refused, problems);
  return {};
}

std::vector<std::string> header_lines(const ExportRequest& request) {
  const Calibration& c = request.calibration;
  const auto used = std::count_if(c.views.begin(), c.views.end(), [](const auto& view) { return view.used; });
  return {safe("Calibrated by " + c.software + " (session " + request.session + "): method " + c.method +
               ", verdict " + c.observability.verdict + ", " +
               formatted("%ld of %s", static_cast<long>(used), counted(c.views.size(), "view").c_str())),
          "T_parent_child is the pose of the child in the parent: p_parent = R p_child + t; m, rad"};
}

std::string hash_comments(const ExportRequest& request) {
  std::string out;
  for (const std::string& line : header_lines(request)) out += "# " + line + "\n";
  return out;
}

std::string sigma_text(const Connection& connection) {
  if (!connection.estimated) return "known, not estimated";
  if (!connection.covariance) return "from several estimates";
  const Matrix6d& C = *connection.covariance;
  return formatted("sigma %.2f mm, %.2f mrad", 1e3 * std::sqrt(C.bottomRightCorner<3, 3>().trace()),
                   1e3 * std::sqrt(C.topLeftCorner<3, 3>().trace()));
}

tl::unexpected<Error> inexpressible(const std::string& format, const std::string& what,
                                    const std::string& hint) {
  return fail(ErrorCode::refused, "", format + " cannot express this: " + what, hint);
}

}  // namespace ca2
