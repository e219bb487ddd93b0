/// Static transforms as tf2_ros publishes them. The pose of the child frame in its parent is the transform
/// that tf2 calls frame_id -> child_frame_id.
#include <pugixml.hpp>
#include <sstream>

#include "core/export/selection.h"
#include "core/io/yaml_text.h"

namespace ca2 {
namespace {

/// Name of the publishing node: a ROS name has no - . or /.
std::string node_name(const ExportTransform& t) {
  std::string name = "static_" + t.parent + "_to_" + t.child;
  for (char& c : name) {
    if (c == '-' || c == '.' || c == '/') c = '_';
  }
  return name;
}

struct Numbers {
  std::vector<std::string> translation, quaternion;  ///< x y z and x y z w
};

Numbers numbers(const ExportTransform& t) {
  const Eigen::Vector3d& p = t.connection.T.t;
  const Eigen::Quaterniond q = t.connection.T.quaternion();
  return {{exact(p.x()), exact(p.y()), exact(p.z())},
          {exact(q.x()), exact(q.y()), exact(q.z()), exact(q.w())}};
}

/// Arguments of ROS 2's static_transform_publisher: options with names, so that no order can be mistaken.
std::vector<std::string> flags(const ExportTransform& t) {
  const Numbers n = numbers(t);
  return {"--x",
          n.translation[0],
          "--y",
          n.translation[1],
          "--z",
          n.translation[2],
          "--qx",
          n.quaternion[0],
          "--qy",
          n.quaternion[1],
          "--qz",
          n.quaternion[2],
          "--qw",
          n.quaternion[3],
          "--frame-id",
          t.parent,
          "--child-frame-id",
          t.child};
}

std::string joined(const std::vector<std::string>& words) {
  std::string line;
  for (const std::string& word : words) line += (line.empty() ? "" : " ") + word;
  return line;
}

std::string commands(const ExportRequest& request, const std::vector<ExportTransform>& transforms) {
  std::string out = hash_comments(request);
  for (const ExportTransform& t : transforms) {
    out += "# pose of " + t.child + " in " + t.parent + " (" + sigma_text(t.connection) + ")\n";
    // Every publisher keeps running: all but the last go to the background.
    out += "ros2 run tf2_ros static_transform_publisher " + joined(flags(t)) +
           (&t == &transforms.back() ? "\n" : " &\n");
  }
  return out;
}

std::string python_launch(const ExportRequest& request, const std::vector<ExportTransform>& transforms) {
  std::string out = hash_comments(request) +
                    "from launch import LaunchDescription\n"
                    "from launch_ros.actions import Node\n\n\n"
                    "def generate_launch_description():\n"
                    "    return LaunchDescription([\n";
  for (const ExportTransform& t : transforms) {
    out += "        # " + sigma_text(t.connection) + "\n";
    out += "        Node(package='tf2_ros', executable='static_transform_publisher', name='" + node_name(t) +
           "',\n             arguments=[";
    const std::vector<std::string> words = flags(t);
    for (std::size_t i = 0; i < words.size(); ++i) out += (i ? ", '" : "'") + words[i] + "'";
    out += "]),\n";
  }
  return out + "    ])\n";
}

std::string xml_launch(const ExportRequest& request, const std::vector<ExportTransform>& transforms,
                       bool ros1) {
  pugi::xml_document document;
  for (const std::string& line : header_lines(request)) {
    document.append_child(pugi::node_comment).set_value((" " + line + " ").c_str());
  }
  pugi::xml_node launch = document.append_child("launch");
  for (const ExportTransform& t : transforms) {
    launch.append_child(pugi::node_comment).set_value((" " + sigma_text(t.connection) + " ").c_str());
    pugi::xml_node node = launch.append_child("node");
    node.append_attribute("pkg") = "tf2_ros";
    node.append_attribute(ros1 ? "type" : "exec") = "static_transform_publisher";
    node.append_attribute("name") = node_name(t).c_str();
    const Numbers n = numbers(t);
    // ROS 1 knows positions only: x y z qx qy qz qw frame child.
    const std::string arguments =
        ros1 ? joined(n.translation) + " " + joined(n.quaternion) + " " + t.parent + " " + t.child
             : joined(flags(t));
    node.append_attribute("args") = arguments.c_str();
  }
  std::ostringstream out;
  document.save(out, "  ");
  return out.str();
}

}  // namespace

Result<ExportFiles> export_ros(const ExportRequest& request) {
  const auto transforms = select_default_tree(request);
  if (!transforms) return fail(transforms.error());
  if (const auto names = check_frame_names(*transforms); !names) return fail(names.error());
  return ExportFiles{{"static_transforms.sh", commands(request, *transforms)},
                     {"static_transforms.launch.xml", xml_launch(request, *transforms, false), false},
                     {"static_transforms.launch.py", python_launch(request, *transforms), false},
                     {"static_transforms_ros1.launch", xml_launch(request, *transforms, true), false}};
}

}  // namespace ca2
