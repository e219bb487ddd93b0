/// @file Every command there is, behind every door.
#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/types/result.h"

namespace ca2 {

class CaptureHost;
class Recorder;
class PreviewMaker;
struct DaemonStatus;

/// What commands act on.
struct CommandTargets {
  CaptureHost& capture;
  Recorder& recorder;
  PreviewMaker& previews;
  std::function<DaemonStatus()> status;
};

/// Called once, in the loop's thread, perhaps much later.
using CommandAnswer = std::function<void(Result<nlohmann::json>)>;

/// `origin` is who asks, for the log: "uid 1000", "lcm pilot". What is wrong with a command is answered as an
/// error, never thrown.
void dispatch(const CommandTargets& targets, const std::string& origin, const std::string& command,
              const nlohmann::json& arguments, CommandAnswer answer);

}  // namespace ca2
