/// @file What a benchmark of `ca2 bench` is.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "core/types/result.h"

namespace ca2 {

struct BenchOptions {
  std::filesystem::path data;  ///< directory with other people's recordings; empty: only what is generated
  bool json = false;
  int repeats = 9;     ///< of every measurement, interleaved with its peer's
  double seconds = 3;  ///< ingest: of each load at a steady rate
  // Of accuracy benchmarks:
  std::uint64_t seed = 1;
  int trials = 0;              ///< per cell; 0: as many as quick or full asks for
  bool full = false;           ///< every cell and 100 trials
  std::string only;            ///< only experiments whose name contains this
  std::filesystem::path plot;  ///< where to write the plot, SVG; empty: nowhere
};

}  // namespace ca2
