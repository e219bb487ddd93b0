/// @file What a person is told while capturing: one value, made by the pipeline, shown by every door.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/guidance/next_pose.h"

namespace ca2 {

/// The one big word.
enum class CaptureState {
  waiting,    ///< no sensor pair sees the board
  moving,     ///< seen, but it moves
  holding,    ///< still: the dwell runs
  capturing,  ///< the view is being written
  captured,   ///< stored; shown until the board moves on
  done,       ///< the target is reached
};

struct SensorStatus {
  std::string name;
  bool is_camera = false;
  bool silent = true;        ///< nothing came within two periods
  bool sees_board = false;   ///< in its newest searched frame
  double rate = 0;           ///< frames or scans per second that came in
  std::uint64_t frames = 0;  ///< that came in
  std::uint64_t shed = 0;    ///< not searched for want of time
  double motion = 0;         ///< camera: px; LiDAR: m, over the stillness window; NaN: not known
  double motion_limit = 0;   ///< in the same unit
  std::uint64_t let_go = 0;  ///< pictures or scans of a hold that went on, let go of for want of memory
};

struct CaptureStatus {
  CaptureState state = CaptureState::waiting;
  std::string reason;   ///< why it is in this state, for a person: "board moves 3.1 px in left; hold still"
  double progress = 0;  ///< of the dwell, 0..1
  bool automatic = true;
  int views = 0;  ///< stored
  int used = 0;   ///< in the newest solve
  std::vector<SensorStatus> sensors;
  std::string last_event;                   ///< newest event's text
  std::optional<double> sigma_translation;  ///< m, worst over the rig's transforms; nothing before a solve
  std::optional<double> sigma_rotation;     ///< rad
  double target_translation = 0;            ///< m
  double target_rotation = 0;               ///< rad
  std::string verdict;                      ///< the newest solve's; its refusal in words where it refused
  std::optional<NextPose> next;
};

}  // namespace ca2
