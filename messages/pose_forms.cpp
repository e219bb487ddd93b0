#include "messages/pose_forms.h"

#include <ca2/pose_v1_t.hpp>
#include <nlohmann/json.hpp>

namespace ca2 {

nlohmann::json pose_to_json(const Pose& pose) {
  const Eigen::Quaterniond q = pose.quaternion();
  return {{"translation", {pose.t.x(), pose.t.y(), pose.t.z()}},
          {"rotation", {{"x", q.x()}, {"y", q.y()}, {"z", q.z()}, {"w", q.w()}}}};
}

Pose pose_from_json(const nlohmann::json& json) {
  const auto& t = json.at("translation");
  const auto& q = json.at("rotation");
  return Pose::from_quaternion(Eigen::Quaterniond(q.at("w"), q.at("x"), q.at("y"), q.at("z")),
                               Eigen::Vector3d(t.at(0), t.at(1), t.at(2)));
}

pose_v1_t pose_to_lcm(const Pose& pose) {
  const Eigen::Quaterniond q = pose.quaternion();
  pose_v1_t out;
  out.x = pose.t.x();
  out.y = pose.t.y();
  out.z = pose.t.z();
  out.qx = q.x();
  out.qy = q.y();
  out.qz = q.z();
  out.qw = q.w();
  return out;
}

Pose pose_from_lcm(const pose_v1_t& in) {
  return Pose::from_quaternion(Eigen::Quaterniond(in.qw, in.qx, in.qy, in.qz), {in.x, in.y, in.z});
}

}  // namespace ca2
