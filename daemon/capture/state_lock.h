/// @file One daemon to a directory of sessions.
#pragma once

#include <filesystem>

#include "core/types/result.h"
#include "drivers/net/unique_fd.h"

namespace ca2 {

/// Holds the directory, which is made where it is not there, until the descriptor is closed: two daemons
/// would number their views alike. ErrorCode::unavailable where another one holds it. None (-1) where the
/// directory cannot be opened: the store says that when it writes.
Result<UniqueFd> lock_state(const std::filesystem::path& directory);

}  // namespace ca2
