#include "daemon/dispatch/arguments.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/types/text.h"

namespace ca2 {

using nlohmann::json;

Arguments::Arguments(const json& given) : json_(given) {
  if (!json_.is_object() && !json_.is_null()) problem("the arguments must be an object");
}

void Arguments::problem(const std::string& what) {
  problems_.push_back({"", what, ""});
}

const json* Arguments::find(const std::string& name, bool optional) {
  known_.insert(name);
  if (json_.is_object()) {
    if (const auto found = json_.find(name); found != json_.end()) return &*found;
  }
  if (!optional) problem("'" + name + "' is missing");
  return nullptr;
}

bool Arguments::flag(const std::string& name, std::optional<bool> otherwise) {
  const json* value = find(name, otherwise.has_value());
  if (value && !value->is_boolean()) problem("'" + name + "' must be true or false");
  return value && value->is_boolean() ? value->get<bool>() : otherwise.value_or(false);
}

long long Arguments::integer(const std::string& name, long long least, long long most,
                             std::optional<long long> otherwise) {
  const json* value = find(name, otherwise.has_value());
  if (!value) return otherwise.value_or(least);
  if (value->is_number_integer()) {
    const auto number = value->get<long long>();
    if (number >= least && number <= most) return number;
  }
  problem(formatted("'%s' must be a whole number from %lld to %lld", name.c_str(), least, most));
  return least;
}

double Arguments::number(const std::string& name, double least, double most,
                         std::optional<double> otherwise) {
  const json* value = find(name, otherwise.has_value());
  if (!value) return otherwise.value_or(least);
  if (value->is_number()) {
    const double number = value->get<double>();
    if (number >= least && number <= most) return number;
  }
  problem(formatted("'%s' must be a number from %g to %g", name.c_str(), least, most));
  return least;
}

std::string Arguments::text(const std::string& name, std::optional<std::string> otherwise) {
  const json* value = find(name, otherwise.has_value());
  if (value && !value->is_string()) problem("'" + name + "' must be a text");
  return value && value->is_string() ? value->get<std::string>() : otherwise.value_or("");
}

Result<void> Arguments::done() {
  if (json_.is_object()) {
    for (const auto& [name, value] : json_.items()) {
      if (!known_.count(name)) problem("there is no argument '" + name.substr(0, 64) + "'");
    }
  }
  if (!problems_.empty()) return fail(ErrorCode::usage, problems_);
  return {};
}

}  // namespace ca2
