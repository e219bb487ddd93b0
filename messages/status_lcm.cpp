#include <ca2/status_v1_t.hpp>
#include <cmath>

#include "messages/pose_forms.h"
#include "messages/status.h"

namespace ca2 {
namespace {

constexpr std::int64_t ns_per_us = 1000;
constexpr double not_known = std::numeric_limits<double>::quiet_NaN();

std::optional<double> known(double value) {
  return std::isnan(value) ? std::nullopt : std::optional(value);
}

sensor_v1_t sensor_to_lcm(const SensorStatus& sensor, const SensorHealth& health) {
  sensor_v1_t out;
  out.name = sensor.name;
  out.is_camera = sensor.is_camera;
  out.supervision = health.supervision;
  out.problem = health.problem;
  out.device = health.device;
  out.silent = sensor.silent;
  out.sees_board = sensor.sees_board;
  out.rate = sensor.rate;
  out.frames = static_cast<std::int64_t>(sensor.frames);
  out.shed = static_cast<std::int64_t>(sensor.shed);
  out.lost = static_cast<std::int64_t>(health.lost);
  out.reopened = static_cast<std::int64_t>(health.reopened);
  out.motion = sensor.motion;
  out.motion_limit = sensor.motion_limit;
  out.clock_sigma = health.clock_sigma;
  return out;
}

void sensor_from_lcm(const sensor_v1_t& in, DaemonStatus& status) {
  SensorStatus& sensor = status.capture.sensors.emplace_back();
  sensor.name = in.name;
  sensor.is_camera = in.is_camera != 0;
  sensor.silent = in.silent != 0;
  sensor.sees_board = in.sees_board != 0;
  sensor.rate = in.rate;
  sensor.frames = static_cast<std::uint64_t>(in.frames);
  sensor.shed = static_cast<std::uint64_t>(in.shed);
  sensor.motion = in.motion;
  sensor.motion_limit = in.motion_limit;
  SensorHealth& health = status.sensors[in.name];
  health.supervision = in.supervision;
  health.problem = in.problem;
  health.device = in.device;
  health.lost = static_cast<std::uint64_t>(in.lost);
  health.reopened = static_cast<std::uint64_t>(in.reopened);
  health.clock_sigma = in.clock_sigma;
}

}  // namespace

status_v1_t to_lcm(const DaemonStatus& status) {
  const CaptureStatus& capture = status.capture;
  status_v1_t out;
  out.utime = status.time / ns_per_us;
  out.sequence = static_cast<std::int64_t>(status.sequence);
  out.software = status.software;
  out.session = status.session;
  out.state = state_name(capture.state);
  out.reason = capture.reason;
  out.progress = capture.progress;
  out.automatic = capture.automatic;
  out.views = capture.views;
  out.used = capture.used;
  for (const SensorStatus& sensor : capture.sensors) {
    const auto health = status.sensors.find(sensor.name);
    out.sensors.push_back(
        sensor_to_lcm(sensor, health == status.sensors.end() ? SensorHealth() : health->second));
  }
  out.sensor_count = static_cast<std::int32_t>(out.sensors.size());
  out.last_event = capture.last_event;
  out.sigma_translation = capture.sigma_translation.value_or(not_known);
  out.sigma_rotation = capture.sigma_rotation.value_or(not_known);
  out.target_translation = capture.target_translation;
  out.target_rotation = capture.target_rotation;
  out.verdict = capture.verdict;
  out.solving = status.solving;
  out.has_next = capture.next.has_value();
  const NextPose next = capture.next.value_or(NextPose());
  out.next_words = next.words;
  out.next_camera = next.camera;
  out.next_pose = pose_to_lcm(next.T_camera_board);
  out.next_sigma_translation = next.sigma_translation;
  out.next_sigma_rotation = next.sigma_rotation;
  out.storage_problem = status.storage_problem;
  out.recording = status.recording;
  out.recording_dropped = static_cast<std::int64_t>(status.recording_dropped);
  out.refused_commands = static_cast<std::int64_t>(status.refused_commands);
  return out;
}

DaemonStatus from_lcm(const status_v1_t& in) {
  DaemonStatus status;
  CaptureStatus& capture = status.capture;
  status.time = in.utime * ns_per_us;
  status.sequence = static_cast<std::uint64_t>(in.sequence);
  status.software = in.software;
  status.session = in.session;
  capture.state = state_of(in.state);
  capture.reason = in.reason;
  capture.progress = in.progress;
  capture.automatic = in.automatic != 0;
  capture.views = in.views;
  capture.used = in.used;
  for (const sensor_v1_t& sensor : in.sensors) sensor_from_lcm(sensor, status);
  capture.last_event = in.last_event;
  capture.sigma_translation = known(in.sigma_translation);
  capture.sigma_rotation = known(in.sigma_rotation);
  capture.target_translation = in.target_translation;
  capture.target_rotation = in.target_rotation;
  capture.verdict = in.verdict;
  status.solving = in.solving != 0;
  if (in.has_next) {
    capture.next = NextPose{in.next_words, in.next_camera, pose_from_lcm(in.next_pose),
                            in.next_sigma_translation, in.next_sigma_rotation};
  }
  status.storage_problem = in.storage_problem;
  status.recording = in.recording;
  status.recording_dropped = static_cast<std::uint64_t>(in.recording_dropped);
  status.refused_commands = static_cast<std::uint64_t>(in.refused_commands);
  return status;
}

}  // namespace ca2
