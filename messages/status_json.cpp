#include <cmath>
#include <nlohmann/json.hpp>

#include "messages/pose_forms.h"
#include "messages/status.h"

namespace ca2 {
namespace {

using nlohmann::json;

constexpr std::string_view state_names[] = {"waiting", "moving", "holding", "capturing", "captured", "done"};

json number(double value) {
  return std::isfinite(value) ? json(value) : json(nullptr);
}

json number(const std::optional<double>& value) {
  return value ? number(*value) : json(nullptr);
}

/// null reads as NaN.
double to_number(const json& value) {
  return value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>();
}

/// The library would convert 1e300 too.
template <class Integer>
void read_integer(const json& value, Integer& out) {
  out = static_cast<Integer>(value.get_ref<const json::number_integer_t&>());
}

std::optional<double> to_optional(const json& value) {
  return value.is_null() ? std::nullopt : std::optional(value.get<double>());
}

json sensor_json(const SensorStatus& sensor, const SensorHealth& health) {
  return {{"name", sensor.name},
          {"kind", sensor.is_camera ? "camera" : "lidar"},
          {"supervision", health.supervision},
          {"problem", health.problem},
          {"device", health.device},
          {"silent", sensor.silent},
          {"sees_board", sensor.sees_board},
          {"rate", number(sensor.rate)},
          {"frames", sensor.frames},
          {"shed", sensor.shed},
          {"let_go", sensor.let_go},
          {"lost", health.lost},
          {"reopened", health.reopened},
          {"motion", number(sensor.motion)},
          {"motion_limit", number(sensor.motion_limit)},
          {"clock_sigma", number(health.clock_sigma)}};
}

void read_sensor(const json& in, DaemonStatus& out) {
  SensorStatus& sensor = out.capture.sensors.emplace_back();
  sensor.name = in.at("name");
  sensor.is_camera = in.at("kind") == "camera";
  sensor.silent = in.at("silent");
  sensor.sees_board = in.at("sees_board");
  sensor.rate = to_number(in.at("rate"));
  read_integer(in.at("frames"), sensor.frames);
  read_integer(in.at("shed"), sensor.shed);
  read_integer(in.at("let_go"), sensor.let_go);
  sensor.motion = to_number(in.at("motion"));
  sensor.motion_limit = to_number(in.at("motion_limit"));
  SensorHealth& health = out.sensors[sensor.name];
  health.supervision = in.at("supervision");
  health.problem = in.at("problem");
  health.device = in.at("device");
  read_integer(in.at("lost"), health.lost);
  read_integer(in.at("reopened"), health.reopened);
  health.clock_sigma = to_number(in.at("clock_sigma"));
}

json next_json(const NextPose& next) {
  return {{"words", next.words},
          {"camera", next.camera},
          {"T_camera_board", pose_to_json(next.T_camera_board)},
          {"sigma_translation", number(next.sigma_translation)},
          {"sigma_rotation", number(next.sigma_rotation)}};
}

NextPose read_next(const json& in) {
  NextPose next;
  next.words = in.at("words");
  next.camera = in.at("camera");
  next.T_camera_board = pose_from_json(in.at("T_camera_board"));
  next.sigma_translation = to_number(in.at("sigma_translation"));
  next.sigma_rotation = to_number(in.at("sigma_rotation"));
  return next;
}

DaemonStatus read_status(const json& in) {
  DaemonStatus out;
  read_integer(in.at("time"), out.time);
  read_integer(in.at("sequence"), out.sequence);
  out.software = in.at("software");
  out.session = in.at("session");
  CaptureStatus& capture = out.capture;
  capture.state = state_of(in.at("state").get<std::string>());
  capture.reason = in.at("reason");
  capture.progress = to_number(in.at("progress"));
  capture.automatic = in.at("automatic");
  read_integer(in.at("views"), capture.views);
  read_integer(in.at("used"), capture.used);
  for (const json& sensor : in.at("sensors")) read_sensor(sensor, out);
  capture.last_event = in.at("last_event");
  capture.sigma_translation = to_optional(in.at("sigma_translation"));
  capture.sigma_rotation = to_optional(in.at("sigma_rotation"));
  capture.target_translation = to_number(in.at("target_translation"));
  capture.target_rotation = to_number(in.at("target_rotation"));
  capture.verdict = in.at("verdict");
  if (const json& next = in.at("next"); !next.is_null()) capture.next = read_next(next);
  out.solving = in.at("solving");
  out.storage_problem = in.at("storage_problem");
  out.recording = in.at("recording");
  read_integer(in.at("recording_dropped"), out.recording_dropped);
  const json& cost = in.at("store_cost");
  read_integer(cost.at("views"), out.store_cost.views);
  out.store_cost.saving = cost.at("saving");
  out.store_cost.searching = cost.at("searching");
  read_integer(in.at("refused_commands"), out.refused_commands);
  return out;
}

}  // namespace

std::string_view state_name(CaptureState state) {
  return state_names[static_cast<std::size_t>(state)];
}

CaptureState state_of(std::string_view name) {
  for (std::size_t i = 0; i < std::size(state_names); ++i) {
    if (state_names[i] == name) return static_cast<CaptureState>(i);
  }
  return CaptureState::waiting;
}

json to_json(const DaemonStatus& status) {
  const CaptureStatus& capture = status.capture;
  json sensors = json::array();
  for (const SensorStatus& sensor : capture.sensors) {
    const auto health = status.sensors.find(sensor.name);
    sensors.push_back(sensor_json(sensor, health == status.sensors.end() ? SensorHealth() : health->second));
  }
  return {{"time", status.time},
          {"sequence", status.sequence},
          {"software", status.software},
          {"session", status.session},
          {"state", state_name(capture.state)},
          {"reason", capture.reason},
          {"progress", number(capture.progress)},
          {"automatic", capture.automatic},
          {"views", capture.views},
          {"used", capture.used},
          {"sensors", std::move(sensors)},
          {"last_event", capture.last_event},
          {"sigma_translation", number(capture.sigma_translation)},
          {"sigma_rotation", number(capture.sigma_rotation)},
          {"target_translation", number(capture.target_translation)},
          {"target_rotation", number(capture.target_rotation)},
          {"verdict", capture.verdict},
          {"next", capture.next ? next_json(*capture.next) : json(nullptr)},
          {"solving", status.solving},
          {"storage_problem", status.storage_problem},
          {"recording", status.recording},
          {"recording_dropped", status.recording_dropped},
          {"store_cost",
           {{"views", status.store_cost.views},
            {"saving", status.store_cost.saving},
            {"searching", status.store_cost.searching}}},
          {"refused_commands", status.refused_commands}};
}

Result<DaemonStatus> status_from_json(const json& json) {
  try {
    return read_status(json);
  } catch (const nlohmann::json::exception& error) {
    return fail(ErrorCode::data, "", std::string("the daemon's status is not understood: ") + error.what(),
                "are the daemon and this program of the same version?");
  }
}

}  // namespace ca2
