/// @file What a file fuzz_*.cpp in this folder defines. From each of them two programs are made: under
/// CA2_FUZZ (clang) the libFuzzer target of that name, and always a test that runs it over mutated seeds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

namespace ca2::fuzz {

/// Small inputs of the format, valid ones among them: where mutation starts from. A target may go without.
__attribute__((weak)) std::vector<std::string> seeds();

/// The target's seeds, or one empty input.
inline std::vector<std::string> all_seeds() {
  return seeds ? seeds() : std::vector<std::string>{""};
}

/// Ends the run with the input as a finding.
inline void require(bool condition, const char* what) {
  if (condition) return;
  std::fprintf(stderr, "fuzz: %s\n", what);
  std::abort();
}

}  // namespace ca2::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
