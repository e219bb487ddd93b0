/// @file Warnings on stderr: what a command does without.
#pragma once

#include <vector>

#include "core/types/result.h"

namespace ca2 {

/// A line each, as errors are printed.
void print_warnings(const std::vector<Problem>& problems);

}  // namespace ca2
