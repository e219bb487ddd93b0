/// @file A command's arguments, judged: every problem is told.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/types/result.h"

namespace ca2 {

class Arguments {
 public:
  explicit Arguments(const nlohmann::json& json);

  bool flag(const std::string& name, std::optional<bool> otherwise = {});
  long long integer(const std::string& name, long long least, long long most,
                    std::optional<long long> otherwise = {});
  double number(const std::string& name, double least, double most, std::optional<double> otherwise = {});
  std::string text(const std::string& name, std::optional<std::string> otherwise = {});

  /// ErrorCode::usage with every problem: missing, of the wrong kind, out of range, unknown.
  Result<void> done();

 private:
  const nlohmann::json* find(const std::string& name, bool optional);
  void problem(const std::string& what);

  const nlohmann::json& json_;
  std::set<std::string> known_;
  std::vector<Problem> problems_;
};

}  // namespace ca2
