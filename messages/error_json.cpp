#include "messages/error_json.h"

#include <nlohmann/json.hpp>

namespace ca2 {

using nlohmann::json;

json error_to_json(const Error& error) {
  json problems = json::array();
  for (const Problem& problem : error.problems) {
    problems.push_back({{"where", problem.where}, {"what", problem.what}, {"hint", problem.hint}});
  }
  return {{"code", static_cast<int>(error.code)}, {"problems", std::move(problems)}};
}

Error error_from_json(const json& in) {
  try {
    Error error(static_cast<ErrorCode>(in.at("code").get<int>()), {});
    for (const json& problem : in.at("problems")) {
      error.problems.push_back({problem.at("where"), problem.at("what"), problem.at("hint")});
    }
    if (!error.problems.empty()) return error;
  } catch (const json::exception&) {
    // Told below: an answer that is not understood, whatever is wrong with it.
  }
  return Error(ErrorCode::data, "", "the daemon's error is not understood: " + in.dump().substr(0, 200),
               "are the daemon and this program of the same version?");
}

json reply_to_json(const Result<json>& reply) {
  return reply ? json{{"result", *reply}} : json{{"error", error_to_json(reply.error())}};
}

Result<json> reply_from_json(const json& in) {
  if (in.is_object() && in.contains("result")) return in.at("result");
  return fail(error_from_json(in.is_object() && in.contains("error") ? in.at("error") : in));
}

}  // namespace ca2
