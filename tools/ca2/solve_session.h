/// @file A session's solve with everything that is printed and written, as `ca2 solve` and `ca2 replay` do
/// it.
#pragma once

#include <string>

#include "core/solve/held_values.h"
#include "core/types/result.h"

namespace ca2 {

struct SolveArguments {
  std::string session;
  std::string output;  ///< empty: SESSION/result.yaml
  std::string method = "joint";
  std::string views;
  HeldValues held;
  int best = 0;  ///< so many of the views, those that determine the answer best; 0: all
  bool json = false;
  bool no_cache = false;
  int threads = 0;
};

/// The exit status. A refusal is an error, and sets an earlier result aside.
Result<int> solve_session(const SolveArguments& arguments);

}  // namespace ca2
