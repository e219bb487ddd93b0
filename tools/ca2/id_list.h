/// @file Lists of view numbers as people write them: "1,4,7-9".
#pragma once

#include <string>
#include <vector>

#include "core/types/result.h"

namespace ca2 {

/// Ascending, without repeats. ErrorCode::usage names what cannot be read.
Result<std::vector<int>> parse_id_list(const std::string& text);

}  // namespace ca2
