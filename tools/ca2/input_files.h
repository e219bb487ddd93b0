/// @file The files that a session is read from, and that nobody writes over.
#pragma once

#include <filesystem>
#include <vector>

#include "core/session/session.h"

namespace ca2 {

/// Every file that the session is read from: session.yaml, what it names, and the views'.
std::vector<std::filesystem::path> input_files(const Session& session);

/// ErrorCode::cannot_create where the output, by whatever name, is one of the inputs.
Result<void> spare_inputs(const std::filesystem::path& output,
                          const std::vector<std::filesystem::path>& inputs);

}  // namespace ca2
