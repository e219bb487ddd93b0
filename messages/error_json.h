/// @file Errors as JSON, so that one raised in the daemon is printed by the command line like its own.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "core/types/result.h"

namespace ca2 {

/// {"code": 69, "problems": [{"where": "", "what": "", "hint": ""}]}
nlohmann::json error_to_json(const Error& error);
/// What cannot be read as an error is ErrorCode::data and says so.
Error error_from_json(const nlohmann::json& json);

/// A whole reply: {"result": value} or {"error": {...}}.
nlohmann::json reply_to_json(const Result<nlohmann::json>& reply);
Result<nlohmann::json> reply_from_json(const nlohmann::json& json);

}  // namespace ca2
