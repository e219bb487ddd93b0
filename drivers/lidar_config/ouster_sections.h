/// @file Ouster's metadata from firmware that only gives it section by section.
#pragma once

#include <functional>
#include <string>

#include "core/types/result.h"

namespace ca2 {

/// Asks for every section by its name ("sensor_info", ...) and puts them and `config` together in the newer
/// layout. What a section answers that is no object ("error: Command not recognized.") is kept as text: the
/// reader of metadata takes that for absent, as in the files of the vendor's own tools.
Result<std::string> assemble_ouster_metadata(
    const std::function<Result<std::string>(const std::string& section)>& ask,
    const Result<std::string>& config);

}  // namespace ca2
