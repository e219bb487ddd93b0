/// Fills an empty corpus directory, the first argument of a libFuzzer target, with the target's seeds.
#include <filesystem>
#include <fstream>

#include "tests/fuzz/fuzz_target.h"

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  namespace fs = std::filesystem;
  for (int i = 1; i < *argc; ++i) {
    const fs::path directory = (*argv)[i];
    if (!fs::is_directory(directory)) continue;
    if (!fs::is_empty(directory)) break;
    int number = 0;
    for (const std::string& seed : ca2::fuzz::all_seeds()) {
      std::ofstream(directory / ("seed-" + std::to_string(number++)), std::ios::binary) << seed;
    }
    break;
  }
  return 0;
}
