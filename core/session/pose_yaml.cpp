#include "core/session/pose_yaml.h"

#include <cmath>

#include "core/io/yaml_text.h"

namespace ca2 {
namespace {

constexpr double max_norm_error = 1e-3;

/// Matrix to quaternion and back rounds: usually nothing changes any more after a few rounds. Some rotations
/// go round in a circle of a few last digits; those are turned by as little (under 1e-13 rad) until they
/// rest.
Pose settled(const Pose& pose) {
  for (int attempt = 0; attempt < 200; ++attempt) {
    Pose candidate = pose;
    candidate.R *= so3_exp(5e-16 * attempt * Eigen::Vector3d::Unit(attempt % 3));
    for (int round = 0; round < 8; ++round) {
      const Pose again = Pose::from_quaternion(candidate.quaternion(), candidate.t);
      if (again.R == candidate.R) return candidate;
      candidate = again;
    }
  }
  return pose;
}

std::optional<Eigen::Quaterniond> read_quaternion(YamlReader& reader, const YamlNode* node) {
  if (!reader.map(node, "rotation", {"x", "y", "z", "w"})) return std::nullopt;
  Eigen::Vector4d xyzw;
  bool complete = true;
  for (int i = 0; i < 4; ++i) {
    static constexpr const char* names[] = {"x", "y", "z", "w"};
    const auto value = reader.number(reader.require(*node, names[i], "rotation"), -2, 2);
    complete = complete && value;
    xyzw[i] = value.value_or(0);
  }
  if (!complete) return std::nullopt;
  if (std::abs(xyzw.norm() - 1) > max_norm_error) {
    reader.problem(*node, "the quaternion has the length " + exact(xyzw.norm()) + ", not 1",
                   "are x, y, z, w in the right places?");
    return std::nullopt;
  }
  return Eigen::Quaterniond(xyzw);
}

}  // namespace

std::optional<Pose> read_pose(YamlReader& reader, const YamlNode& map, std::string_view what) {
  const auto translation = reader.numbers(reader.require(map, "translation", what), 3, max_sensor_distance);
  const auto rotation = read_quaternion(reader, reader.require(map, "rotation", what));
  if (!translation || !rotation) return std::nullopt;
  return settled(Pose::from_quaternion(*rotation, Eigen::Vector3d(translation->data())));
}

std::string rotation_text(const Pose& pose) {
  const Eigen::Quaterniond q = pose.quaternion();
  return "{x: " + exact(q.x()) + ", y: " + exact(q.y()) + ", z: " + exact(q.z()) + ", w: " + exact(q.w()) +
         "}";
}

std::string translation_text(const Pose& pose) {
  return exact_list(pose.t);
}

}  // namespace ca2
