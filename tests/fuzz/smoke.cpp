/// Runs the fuzz target it is linked to over mutations of its seeds: what a compiler without libFuzzer can
/// do.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include "tests/fuzz/fuzz_target.h"

namespace ca2::fuzz {
namespace {

void run(const std::string& input) {
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(input.data()), input.size());
}

std::string mutated(std::string input, const std::vector<std::string>& all, std::mt19937_64& random) {
  const auto below = [&](std::size_t limit) { return limit == 0 ? std::size_t{0} : random() % limit; };
  static const std::string interesting[] = {
      std::string("\0", 1), "\xff", "-1", "4294967296", "1e999", "nan", "\n", " ", "{", "[",
      "\x7f\xff\xff\xff"};
  for (std::size_t n = 1 + below(4); n > 0; --n) {
    const std::size_t at = below(input.size() + 1);
    switch (below(6)) {
      case 0:
        if (at < input.size()) input[at] = static_cast<char>(input[at] ^ (1 << below(8)));
        break;
      case 1:
        if (at < input.size()) input[at] = static_cast<char>(random());
        break;
      case 2:
        input.erase(at, below(20));
        break;
      case 3:
        input.insert(at, input.substr(below(input.size()), below(40)));
        break;
      case 4:
        input.replace(std::min(at, input.size()), below(6), interesting[below(std::size(interesting))]);
        break;
      default: {
        const std::string& other = all[below(all.size())];
        input = input.substr(0, at) + other.substr(below(other.size()));
      }
    }
  }
  return input;
}

TEST(Fuzz, SeedsAndTheirTruncations) {
  for (const std::string& seed : all_seeds()) {
    const std::size_t step = 1 + seed.size() / 300;
    for (std::size_t size = 0; size < seed.size(); size += step) run(seed.substr(0, size));
    run(seed);
  }
}

#ifdef CA2_FUZZ_CORPUS
/// What fuzzing found to be worth keeping: every branch it reached is reached again.
TEST(Fuzz, Corpus) {
  for (const auto& entry : std::filesystem::directory_iterator(CA2_FUZZ_CORPUS)) {
    std::ifstream file(entry.path(), std::ios::binary);
    run({std::istreambuf_iterator<char>(file), {}});
  }
}
#endif

TEST(Fuzz, Mutations) {
  const std::vector<std::string> all = all_seeds();
  ASSERT_FALSE(all.empty());
  std::mt19937_64 random(2024);
  for (int i = 0; i < 3000; ++i) run(mutated(all[random() % all.size()], all, random));
}

}  // namespace
}  // namespace ca2::fuzz
