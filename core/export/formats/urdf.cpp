/// URDF: a robot of links and fixed joints, to be merged or included by a xacro.
#include <pugixml.hpp>
#include <sstream>

#include "core/export/rpy.h"
#include "core/export/selection.h"
#include "core/io/yaml_text.h"

namespace ca2 {
namespace {

std::string triple(const Eigen::Vector3d& v) {
  return exact(v.x()) + " " + exact(v.y()) + " " + exact(v.z());
}

void comment(pugi::xml_node parent, const std::string& text) {
  parent.append_child(pugi::node_comment).set_value((" " + text + " ").c_str());
}

void add_joint(pugi::xml_node robot, const ExportTransform& t) {
  robot.append_child("link").append_attribute("name") = t.child.c_str();
  comment(robot, sigma_text(t.connection));
  const Pose& T = t.connection.T;
  const Eigen::Vector3d rpy = rpy_from_rotation(T.R);
  if (near_gimbal_lock(rpy)) {
    const Eigen::Quaterniond q = T.quaternion();
    comment(robot, "the pitch is near 90 degrees, where roll and yaw mean little alone; as a quaternion: x " +
                       exact(q.x()) + " y " + exact(q.y()) + " z " + exact(q.z()) + " w " + exact(q.w()));
  }
  pugi::xml_node joint = robot.append_child("joint");
  joint.append_attribute("name") = (t.parent + "_to_" + t.child).c_str();
  joint.append_attribute("type") = "fixed";
  joint.append_child("parent").append_attribute("link") = t.parent.c_str();
  joint.append_child("child").append_attribute("link") = t.child.c_str();
  pugi::xml_node origin = joint.append_child("origin");
  origin.append_attribute("xyz") = triple(T.t).c_str();
  origin.append_attribute("rpy") = triple(rpy).c_str();
}

}  // namespace

Result<ExportFiles> export_urdf(const ExportRequest& request) {
  const auto transforms = select_default_tree(request);
  if (!transforms) return fail(transforms.error());
  if (const auto names = check_frame_names(*transforms); !names) return fail(names.error());
  pugi::xml_document document;
  pugi::xml_node declaration = document.append_child(pugi::node_declaration);
  declaration.append_attribute("version") = "1.0";
  for (const std::string& line : header_lines(request)) comment(document, line);
  pugi::xml_node robot = document.append_child("robot");
  robot.append_attribute("name") = "ca2_calibration";
  robot.append_child("link").append_attribute("name") = transforms->front().parent.c_str();
  for (const ExportTransform& transform : *transforms) add_joint(robot, transform);
  std::ostringstream out;
  document.save(out, "  ");
  return ExportFiles{{"calibration.urdf", out.str()}};
}

}  // namespace ca2
