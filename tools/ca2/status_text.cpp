#include "tools/ca2/status_text.h"

#include <cmath>

#include "core/types/counted.h"
#include "core/types/text.h"

namespace ca2 {
namespace {

const SensorHealth& health_of(const DaemonStatus& status, const std::string& name) {
  static const SensorHealth unknown;
  const auto found = status.sensors.find(name);
  return found == status.sensors.end() ? unknown : found->second;
}

std::string motion_text(const SensorStatus& sensor) {
  if (!std::isfinite(sensor.motion)) return "";
  return sensor.is_camera
             ? formatted("  moves %.2f of %.2f px", sensor.motion, sensor.motion_limit)
             : formatted("  moves %.1f of %.1f mm", 1e3 * sensor.motion, 1e3 * sensor.motion_limit);
}

}  // namespace

std::string sensor_word(const SensorStatus& sensor, const SensorHealth& health) {
  if (health.supervision != "running") return health.supervision;
  if (sensor.silent) return "silent";
  return sensor.sees_board ? "sees the board" : "no board";
}

std::string sigma_text(const CaptureStatus& capture) {
  const std::string target =
      formatted("target %.3g mm, %.3g mrad", 1e3 * capture.target_translation, 1e3 * capture.target_rotation);
  if (!capture.sigma_translation || !capture.sigma_rotation) return "no answer yet (" + target + ")";
  return formatted("sigma %.2f mm, %.2f mrad (", 1e3 * *capture.sigma_translation,
                   1e3 * *capture.sigma_rotation) +
         target + ")";
}

std::string status_text(const DaemonStatus& status) {
  const CaptureStatus& capture = status.capture;
  std::string out =
      formatted("%-10s %s\n", std::string(state_name(capture.state)).c_str(), capture.reason.c_str());
  out += formatted("session    %s, %s, %d used, %s%s\n",
                   status.session.empty() ? "(none open)" : status.session.c_str(),
                   counted(capture.views, "view").c_str(), capture.used,
                   capture.automatic ? "automatic" : "on request", status.solving ? ", solving" : "");
  for (const SensorStatus& sensor : capture.sensors) {
    const SensorHealth& health = health_of(status, sensor.name);
    out += formatted("%-10s %-15s %5.1f Hz  %llu shed, %llu lost%s", sensor.name.c_str(),
                     sensor_word(sensor, health).c_str(), std::isfinite(sensor.rate) ? sensor.rate : 0.0,
                     static_cast<unsigned long long>(sensor.shed),
                     static_cast<unsigned long long>(health.lost), motion_text(sensor).c_str());
    if (sensor.let_go > 0)
      out += formatted(", %llu let go of", static_cast<unsigned long long>(sensor.let_go));
    out += (health.problem.empty() ? "" : "  " + health.problem) + "\n";
  }
  out += "answer     " + sigma_text(capture) + "\n";
  if (!capture.verdict.empty()) out += "verdict    " + capture.verdict + "\n";
  if (capture.next) {
    out += "next       " + capture.next->words;
    // Before the first answer nothing can be expected of it.
    if (std::isfinite(capture.next->sigma_translation)) {
      out += formatted(" (would give %.2f mm, %.2f mrad)", 1e3 * capture.next->sigma_translation,
                       1e3 * capture.next->sigma_rotation);
    }
    out += "\n";
  }
  if (!capture.last_event.empty()) out += "last       " + capture.last_event + "\n";
  if (!status.storage_problem.empty()) out += "storage    " + status.storage_problem + "\n";
  if (!status.recording.empty()) {
    out += formatted("recording  %s, %llu dropped\n", status.recording.c_str(),
                     static_cast<unsigned long long>(status.recording_dropped));
  }
  if (status.refused_commands > 0) {
    out += formatted("refused    %llu commands over LCM\n",
                     static_cast<unsigned long long>(status.refused_commands));
  }
  return out;
}

std::string status_line(const DaemonStatus& status) {
  const CaptureStatus& capture = status.capture;
  return formatted("%s: %s; %s, %s", std::string(state_name(capture.state)).c_str(), capture.reason.c_str(),
                   counted(capture.views, "view").c_str(), sigma_text(capture).c_str());
}

}  // namespace ca2
