#include "tools/ca2/bench_scenarios.h"

#include <utility>

namespace ca2 {
namespace {

namespace fs = std::filesystem;

/// Beside the program, whatever prefix it was installed to.
fs::path installed() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  return (program.parent_path().parent_path() / "share/ca2/scenarios").lexically_normal();
}

Result<fs::path> folder_of(const fs::path& data) {
  const std::vector<fs::path> places =
      data.empty() ? std::vector<fs::path>{"config/scenarios", installed()} : std::vector{data};
  std::error_code error;
  for (const fs::path& place : places) {
    if (fs::is_directory(place, error)) return place;
  }
  if (!data.empty()) return fail(ErrorCode::data, data.string(), "no such folder");
  return fail(
      ErrorCode::data, "",
      "no scenarios: there is no folder " + places[0].string() + " here, and no " + places[1].string(),
      "say with --data where they are");
}

}  // namespace

Result<std::vector<ScenarioFile>> bench_scenarios(const fs::path& data, const std::vector<std::string>& names,
                                                  const std::string& only) {
  const Result<fs::path> folder = folder_of(data);
  if (!folder) return fail(folder.error());
  std::vector<ScenarioFile> files;
  for (const std::string& name : names) {
    if (name.find(only) == std::string::npos) continue;
    const fs::path path = *folder / (name + ".yaml");
    std::error_code error;
    if (!fs::exists(path, error))
      return fail(ErrorCode::data, path.string(), "no such scenario",
                  "--data is the folder that they are in");
    Result<ScenarioFile> file = read_scenario(path);
    if (!file) return fail(file.error());
    files.push_back(*std::move(file));
  }
  return files;
}

}  // namespace ca2
