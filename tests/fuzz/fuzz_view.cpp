#include "core/session/view_files.h"
#include "tests/fuzz/fuzz_file.h"
#include "tests/fuzz/fuzz_target.h"

namespace ca2::fuzz {

std::vector<std::string> seeds() {
  return {
      "version: 1\nstamps: {left: 1700000000000000000}\nframes: 5\nscans: {top: 3}\ntrigger: auto\ngates: "
      "{}\n"
      "picks: {top: {row: 3, column: 40, radius: 2.5}}\n",
      "picks:\n  tpo: {row: 1, column: 2}\n  top: {row: -1, column: 1e9, radius: nan}\n"};
}

}  // namespace ca2::fuzz

/// A pick is on a grid that there can be; what else there is is said.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace ca2;
  static const fuzz::File file("view.yaml");
  file.write({reinterpret_cast<const char*>(data), size});
  std::vector<Problem> warnings;
  const SessionView view = list_view(file.path.parent_path(), 1, {"left"}, {"top"}, warnings);
  for (const auto& [lidar, pick] : view.picks) {
    fuzz::require(lidar == "top", "a pick of no lidar");
    fuzz::require(pick.row >= 0 && pick.column >= 0 && pick.radius >= 0 && pick.radius <= 10000, "no pixel");
  }
  for (const Problem& warning : warnings) fuzz::require(!warning.where.empty(), "no place");
  return 0;
}
