/// @file How everything fallible answers: a value, or an error that says what is wrong, where, and what to
/// do.
#pragma once

#include <string>
#include <tl/expected.hpp>
#include <utility>
#include <vector>

namespace ca2 {

/// The kinds of failure a caller can tell apart; the values are the programs' exit codes (docs/design.md).
enum class ErrorCode {
  refused = 1,         ///< it ran, but no answer may be given: not observable, gates not met
  usage = 64,          ///< the command line is wrong
  data = 65,           ///< the input data is damaged or does not fit together
  unavailable = 69,    ///< no daemon, no sensor
  internal = 70,       ///< our bug
  cannot_create = 73,  ///< an output cannot be created
  io = 74,             ///< reading or writing failed part-way
  no_permission = 77,
  config = 78,  ///< a rig or configuration file is wrong
};

/// One thing that is wrong. `where` is "file:line:col", "file", or empty.
struct Problem {
  std::string where;
  std::string what;
  std::string hint;  ///< what to do about it; may be empty
};

/// Why an operation failed: at least one problem, all of those that were found.
struct Error {
  ErrorCode code = ErrorCode::internal;
  std::vector<Problem> problems;

  Error(ErrorCode error_code, std::vector<Problem> list) : code(error_code), problems(std::move(list)) {}
  Error(ErrorCode error_code, std::string where, std::string what, std::string hint = {})
      : code(error_code), problems{{std::move(where), std::move(what), std::move(hint)}} {}

  /// One line per problem: "where: what; hint".
  std::string text() const;
};

template <class T>
using Result = tl::expected<T, Error>;

/// An Error on its way into any Result: `return fail(ErrorCode::data, path, "truncated")`.
template <class... Args>
tl::unexpected<Error> fail(ErrorCode code, Args&&... args) {
  return tl::unexpected<Error>(Error(code, std::forward<Args>(args)...));
}

/// Passes another Result's error on.
inline tl::unexpected<Error> fail(Error error) {
  return tl::unexpected<Error>(std::move(error));
}

}  // namespace ca2
