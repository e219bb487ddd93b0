/// @file What the daemon says of itself: one value, whichever door it leaves by.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/capture/status.h"
#include "core/types/result.h"

namespace ca2 {

class status_v1_t;

/// How a sensor's device does, beside what the pipeline knows of its data.
struct SensorHealth {
  std::string supervision = "opening";  ///< "opening", "running", "retrying"
  std::string problem;                  ///< why it does not run; empty when it does
  std::string device;                   ///< what is open, for people
  std::uint64_t lost = 0;               ///< damaged or lost on the way, dropped by the kernel or a full queue
  std::uint64_t reopened = 0;
  double clock_sigma = std::numeric_limits<double>::quiet_NaN();  ///< s; NaN: not known
};

/// What storing views has cost so far, of a CPU.
struct StoreCost {
  std::uint64_t views = 0;
  double saving = 0;     ///< s: gathering, encoding and writing them
  double searching = 0;  ///< s: for the board in them, whose features a solve takes
};

struct DaemonStatus {
  std::int64_t time = 0;  ///< ns UTC
  std::uint64_t sequence = 0;
  std::string software;
  std::string session;                          ///< directory; empty while none is open
  CaptureStatus capture;                        ///< its sensors are all of the rig's
  std::map<std::string, SensorHealth> sensors;  ///< by name
  bool solving = false;
  std::string storage_problem;  ///< why views are not being written; empty when they are
  std::string recording;        ///< directory that raw input goes to; empty: not recording
  std::uint64_t recording_dropped = 0;
  StoreCost store_cost;
  std::uint64_t refused_commands = 0;  ///< signed ones, for whatever reason
};

/// "waiting", "moving", ...: the states' names in every format.
std::string_view state_name(CaptureState state);

/// The JSON form, on the control socket, in `ca2 status --json` and in signed replies alike. What is not a
/// finite number is null.
nlohmann::json to_json(const DaemonStatus& status);
Result<DaemonStatus> status_from_json(const nlohmann::json& json);

/// The LCM form. Both hold the same, except that LCM's time is in us, refusals are one number, and what views
/// cost and what holds had no room for is not in it.
status_v1_t to_lcm(const DaemonStatus& status);
DaemonStatus from_lcm(const status_v1_t& message);

}  // namespace ca2
