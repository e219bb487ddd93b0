/// @file What a benchmark of `ca2 bench` is.
#pragma once

#include <filesystem>

#include "core/types/result.h"

namespace ca2 {

struct BenchOptions {
  std::filesystem::path data;  ///< directory with other people's recordings; empty: only what is generated
  bool json = false;
  int repeats = 9;  ///< of every measurement, interleaved with its peer's
};

}  // namespace ca2
