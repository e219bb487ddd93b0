#include "core/export/frame_graph.h"

#include <algorithm>
#include <deque>
#include <optional>

#include "core/geometry/adjoint.h"
#include "core/types/text.h"

namespace ca2 {
namespace {

std::string joined(const std::vector<std::string>& words) {
  std::string list;
  for (const std::string& word : words) list += (list.empty() ? "" : ", ") + word;
  return list;
}

/// A right perturbation of a transform, as seen from the other side of T.
std::optional<Matrix6d> moved(const std::optional<Matrix6d>& covariance, const Pose& T) {
  if (!covariance) return std::nullopt;
  const Matrix6d A = adjoint(T);
  return A * *covariance * A.transpose();
}

}  // namespace

Connection Connection::inverse() const {
  return {T.inverse(), moved(covariance, T), estimated};
}

Connection Connection::operator*(const Connection& next) const {
  Connection whole{T * next.T, std::nullopt, estimated || next.estimated};
  if (!(estimated && next.estimated)) {
    const auto mine = moved(covariance, next.T.inverse());
    if (mine && next.covariance) whole.covariance = *mine + *next.covariance;
  }
  return whole;
}

Pose link_from_optical() {
  Pose T;
  // Columns: where the optical x (right), y (down) and z (forward) point in the link's x forward, y left, z
  // up.
  T.R << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return T;
}

std::string link_name(const std::string& optical_frame) {
  for (const std::string_view ending : {"_optical_frame", "_optical_link", "_optical"}) {
    if (optical_frame.ends_with(ending)) {
      return optical_frame.substr(0, optical_frame.size() - ending.size()) + "_link";
    }
  }
  return optical_frame + "_link";
}

Result<FrameGraph> FrameGraph::of(const Calibration& calibration) {
  FrameGraph graph;
  std::map<std::string, std::string> owner;
  std::vector<Problem> problems;
  const auto take = [&](const std::string& sensor, const std::string& frame) {
    const std::string& name = frame.empty() ? sensor : frame;
    const auto [at, fresh] = owner.emplace(name, sensor);
    if (!fresh && at->second != sensor) {
      problems.push_back({"", "'" + at->second + "' and '" + sensor + "' have the same frame '" + name + "'",
                          "give every sensor a frame of its own in session.yaml and solve again"});
    }
    graph.sensors_.emplace(sensor, name);
  };
  for (const CalibratedTransform& t : calibration.transforms) {
    take(t.parent, t.parent_frame);
    take(t.child, t.child_frame);
  }
  for (const auto& [name, camera] : calibration.cameras) {
    if (!graph.sensors_.count(name)) take(name, "");
    graph.cameras_.push_back(name);
  }
  if (!problems.empty()) return fail(ErrorCode::config, problems);
  for (const auto& [sensor, frame] : graph.sensors_) graph.edges_[frame];
  for (const CalibratedTransform& t : calibration.transforms) {
    // Pairs of one calibration may differ by their noise (methods that solve pair by pair): each is the
    // answer for its own two sensors.
    graph.connect(graph.frame_of(t.parent), graph.frame_of(t.child), {t.T_parent_child, t.covariance, true});
  }
  return graph;
}

void FrameGraph::connect(const std::string& parent, const std::string& child, const Connection& connection) {
  edges_[parent][child] = connection;
  edges_[child][parent] = connection.inverse();
}

std::string FrameGraph::resolved(const std::string& name) const {
  const auto sensor = sensors_.find(name);
  return sensor == sensors_.end() ? name : sensor->second;
}

Result<void> FrameGraph::add(const FrameTransform& t, const std::string& origin) {
  const std::string parent = resolved(t.parent), child = resolved(t.child);
  if (parent == child) return fail(ErrorCode::config, origin, "'" + child + "' is its own parent");
  if (edges_.count(parent) && edges_.count(child)) {
    if (const Result<Connection> known = between(parent, child)) {
      const Vector6d error = known->T.difference(t.T_parent_child);
      if (error.cwiseAbs().maxCoeff() < same_place) return {};
      return fail(
          ErrorCode::config, origin,
          formatted("says where '%s' is relative to '%s', and so does what was known before: they differ "
                    "by %.1f mm and %.1f mrad",
                    child.c_str(), parent.c_str(), 1e3 * error.tail<3>().norm(),
                    1e3 * error.head<3>().norm()),
          "take out the transform that the calibration replaces");
    }
  }
  connect(parent, child, {t.T_parent_child});
  return {};
}

void FrameGraph::connect_links() {
  for (const std::string& camera : cameras_) {
    const std::string& optical = frame_of(camera);
    const std::string link = link_name(optical);
    if (!knows(link) || between(link, optical)) continue;
    connect(link, optical, {link_from_optical()});
  }
}

Result<void> FrameGraph::add_link(const std::string& link, const std::string& camera) {
  for (const std::string& name : cameras_) {
    if (name == camera || frame_of(name) == camera) {
      return add({link, frame_of(name), link_from_optical()}, "--via " + camera);
    }
  }
  return fail(ErrorCode::usage, "", "'" + camera + "' is no camera of this calibration",
              "cameras: " + joined(cameras_));
}

bool FrameGraph::knows(const std::string& name) const {
  return sensors_.count(name) || edges_.count(name);
}

bool FrameGraph::is_camera(const std::string& name) const {
  return std::any_of(cameras_.begin(), cameras_.end(),
                     [&](const std::string& camera) { return camera == name || frame_of(camera) == name; });
}

Result<std::string> FrameGraph::find(const std::string& name) {
  if (knows(name)) return resolved(name);
  for (const std::string& camera : cameras_) {
    if (link_name(frame_of(camera)) != name) continue;
    if (const Result<void> added = add_link(name, camera); !added) return fail(added.error());
    return name;
  }
  return fail(ErrorCode::usage, "", "there is no frame '" + name + "'",
              "known are: " + list() + "; --via names a file with more, or the camera whose link it is");
}

Result<Connection> FrameGraph::between(const std::string& parent, const std::string& child) const {
  std::map<std::string, Connection> reached{{parent, {}}};
  std::deque<std::string> queue{parent};
  while (!queue.empty() && !reached.count(child)) {
    const std::string at = queue.front();
    queue.pop_front();
    const auto edges = edges_.find(at);
    if (edges == edges_.end()) continue;
    for (const auto& [next, connection] : edges->second) {
      if (reached.emplace(next, reached.at(at) * connection).second) queue.push_back(next);
    }
  }
  if (const auto found = reached.find(child); found != reached.end()) return found->second;
  return fail(ErrorCode::usage, "", "nothing connects '" + parent + "' and '" + child + "'",
              "--via names a file with the transforms in between");
}

std::string FrameGraph::list() const {
  std::vector<std::string> names;
  for (const auto& [name, edges] : edges_) names.push_back(name);
  return joined(names);
}

}  // namespace ca2
