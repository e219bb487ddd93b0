/// @file The commands of commands.def.
#pragma once

#include "daemon/dispatch/dispatcher.h"

namespace ca2 {

using CommandHandler = void (*)(const CommandTargets& targets, const nlohmann::json& arguments,
                                CommandAnswer answer);

#define CA2_DAEMON_COMMAND(name, takes, gives) \
  void answer_##name(const CommandTargets& targets, const nlohmann::json& arguments, CommandAnswer answer);
#include "daemon/dispatch/commands.def"
#undef CA2_DAEMON_COMMAND

}  // namespace ca2
