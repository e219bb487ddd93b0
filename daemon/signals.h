/// @file The daemon's signals as a descriptor.
#pragma once

#include <csignal>

#include "drivers/net/unique_fd.h"

namespace ca2 {

/// SIGTERM, SIGINT, SIGHUP. To be called before any thread begins: threads inherit it.
void block_signals();

/// Readable when one of them came.
UniqueFd signal_descriptor();
/// Which; 0 when none.
int next_signal(const UniqueFd& descriptor);

}  // namespace ca2
