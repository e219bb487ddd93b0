/// @file The daemon's status as lines, for pipes and logs.
#pragma once

#include "tools/ca2/daemon_link.h"

namespace ca2 {

/// A line whenever something changes, until Ctrl-C; `json`: an object for every status.
Result<int> follow_status(const DaemonAddress& address, bool json);

}  // namespace ca2
