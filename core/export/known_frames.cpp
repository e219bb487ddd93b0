#include "core/export/known_frames.h"

#include <algorithm>
#include <locale>
#include <optional>
#include <pugixml.hpp>
#include <sstream>

#include "core/export/rpy.h"
#include "core/io/files.h"
#include "core/io/yaml_reader.h"
#include "core/session/pose_yaml.h"

namespace ca2 {
namespace {

/// "x y z"; nothing if it is anything else. An absent attribute is three zeros in URDF.
std::optional<Eigen::Vector3d> triple(const pugi::xml_attribute& attribute) {
  if (!attribute) return Eigen::Vector3d::Zero();
  std::istringstream text(attribute.value());
  text.imbue(std::locale::classic());
  Eigen::Vector3d v;
  std::string more;
  if (!(text >> v.x() >> v.y() >> v.z()) || text >> more || !v.allFinite()) return std::nullopt;
  return v;
}

Result<std::vector<FrameTransform>> parse_urdf(const std::string& text, const std::string& name) {
  pugi::xml_document document;
  const pugi::xml_parse_result parsed = document.load_buffer(text.data(), text.size());
  const auto line = [&](std::ptrdiff_t offset) {
    const auto end =
        text.begin() + std::min<std::ptrdiff_t>(offset, static_cast<std::ptrdiff_t>(text.size()));
    return name + ":" + std::to_string(1 + std::count(text.begin(), end, '\n'));
  };
  if (!parsed)
    return fail(ErrorCode::config, line(parsed.offset),
                std::string("this is not XML: ") + parsed.description());
  const pugi::xml_node robot = document.child("robot");
  if (!robot)
    return fail(ErrorCode::config, name, "has no <robot>",
                "give a URDF (a xacro file must be expanded first)");
  std::vector<FrameTransform> transforms;
  std::vector<Problem> problems;
  for (const pugi::xml_node joint : robot.children("joint")) {
    if (std::string_view(joint.attribute("type").value()) != "fixed") continue;
    const auto xyz = triple(joint.child("origin").attribute("xyz"));
    const auto rpy = triple(joint.child("origin").attribute("rpy"));
    const std::string parent = joint.child("parent").attribute("link").value();
    const std::string child = joint.child("child").attribute("link").value();
    if (!xyz || !rpy || parent.empty() || child.empty()) {
      problems.push_back({line(joint.offset_debug()),
                          std::string("joint '") + joint.attribute("name").value() +
                              "' lacks a parent or child link, or its origin is not made of numbers",
                          "xacro expressions must be expanded first"});
      continue;
    }
    transforms.push_back({parent, child, {rotation_from_rpy(*rpy), *xyz}});
  }
  if (!problems.empty()) return fail(ErrorCode::config, problems);
  return transforms;
}

Result<std::vector<FrameTransform>> parse_yaml_list(const std::string& text, const std::string& name) {
  const Result<YamlNode> root = parse_yaml(text, name);
  if (!root) return fail(root.error());
  YamlReader reader(name);
  std::vector<FrameTransform> transforms;
  if (reader.map(&*root, "known frames", {"version", "extrinsics"})) {
    const YamlNode* list = reader.require(*root, "extrinsics", "known frames");
    if (list && reader.sequence(list, "extrinsics")) {
      for (const YamlNode& item : list->items) {
        if (!reader.map(&item, "an extrinsic", {"parent", "child", "translation", "rotation", "fixed"}))
          continue;
        const auto parent = reader.text(reader.require(item, "parent", "an extrinsic"));
        const auto child = reader.text(reader.require(item, "child", "an extrinsic"));
        const auto pose = read_pose(reader, item, "an extrinsic");
        if (parent && child && pose) transforms.push_back({*parent, *child, *pose});
      }
    }
  }
  if (!reader.problems().empty()) return fail(ErrorCode::config, reader.problems());
  return transforms;
}

}  // namespace

Result<std::vector<FrameTransform>> parse_known_frames(const std::string& text, const std::string& name) {
  const std::size_t first = text.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  const bool xml = first != std::string::npos && text[first] == '<';
  return xml ? parse_urdf(text, name) : parse_yaml_list(text, name);
}

Result<std::vector<FrameTransform>> read_known_frames(const std::filesystem::path& file) {
  const Result<std::string> text = read_text(file, std::size_t{16} << 20);
  if (!text) return fail(text.error());
  return parse_known_frames(*text, file.string());
}

}  // namespace ca2
