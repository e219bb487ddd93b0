/// @file What a subcommand of `ca2` is.
#pragma once

#include <functional>

#include "core/types/result.h"

namespace CLI {
class App;
}

namespace ca2 {

/// A subcommand: declares its options on `app` and returns what runs it. The result is the exit code;
/// errors are printed by the caller.
using CommandBody = std::function<Result<int>()>;
using CommandSetup = CommandBody (*)(CLI::App& app);

int run_command_line(int argc, char** argv);

}  // namespace ca2
