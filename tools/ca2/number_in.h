/// @file The range check of every option that is a number.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace ca2 {

/// A number from `least` to `most`. Unlike CLI::Range it refuses what is no number (nan), too.
CLI::Validator number_in(double least, double most);

/// Seconds that a program may be told to wait or work: more than none, a month at most.
CLI::Validator seconds();

}  // namespace ca2
