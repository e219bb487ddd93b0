#include "core/session/rig.h"
#include "tests/core/session/rig_text.h"
#include "tests/fuzz/fuzz_target.h"

namespace ca2::fuzz {

std::vector<std::string> seeds() {
  return {test::rig_text,
          "version: 1\nboard: {type: charuco, columns: 5, rows: 7, square: 0.04, marker: 0.03}\n"
          "cameras: {a: }\nlidars: {}\n",
          "version: 1\nboard: {type: checkerboard, columns: 4, rows: 5, square: 1}\n"
          "cameras:\n  c: {intrinsics: {model: double_sphere, parameters: [1, 1, 0, 0, -0.2, 0.5]}}\n",
          "a: &a [1, *a, \"x\\x41\", 'y', |\n  text\n  ]\n? b\n: !tag c\n"};
}

}  // namespace ca2::fuzz

/// Every error has a place; whatever is read is written as a text that gives the same rig.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using ca2::fuzz::require;
  const auto rig = ca2::parse_rig(std::string(reinterpret_cast<const char*>(data), size), "input");
  if (!rig) {
    require(!rig.error().problems.empty(), "an error without a problem");
    for (const ca2::Problem& problem : rig.error().problems) require(!problem.where.empty(), "no place");
    return 0;
  }
  const std::string text = ca2::write_rig(*rig);
  const auto again = ca2::parse_rig(text, "again");
  require(again.has_value(), "what was written cannot be read");
  require(ca2::write_rig(*again) == text, "the rig changed");
  return 0;
}
