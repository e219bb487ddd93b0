#include "tools/ca2/input_files.h"

#include <algorithm>

#include "core/io/files.h"
#include "core/io/yaml.h"

namespace ca2 {

namespace fs = std::filesystem;

namespace {

/// Intrinsics, metadata, calibrations: whatever a scalar names that is a file.
void add_named(std::vector<fs::path>& files, const YamlNode& node, const fs::path& directory) {
  std::error_code error;
  if (node.is_scalar() && !node.text.empty() && fs::is_regular_file(directory / node.text, error) &&
      std::ranges::find(files, directory / node.text) == files.end()) {
    files.push_back(directory / node.text);
  }
  for (const YamlNode& item : node.items) add_named(files, item, directory);
}

}  // namespace

std::vector<fs::path> input_files(const Session& session) {
  const fs::path rig = session.directory / "session.yaml";
  std::vector<fs::path> files{rig};
  if (const Result<std::string> text = read_text(rig, max_yaml_bytes)) {
    if (const Result<YamlNode> root = parse_yaml(*text, rig.string()))
      add_named(files, *root, session.directory);
  }
  for (const SessionView& view : session.views) {
    std::error_code error;
    if (fs::exists(view.directory / "view.yaml", error)) files.push_back(view.directory / "view.yaml");
    for (const auto* sensors : {&view.images, &view.clouds}) {
      for (const auto& [sensor, file] : *sensors) files.push_back(file);
    }
  }
  return files;
}

Result<void> spare_inputs(const fs::path& output, const std::vector<fs::path>& inputs) {
  std::error_code error;
  const bool input = std::any_of(inputs.begin(), inputs.end(), [&](const fs::path& read) {
    return fs::equivalent(output, read, error) && !error;
  });
  if (!input) return {};
  return fail(ErrorCode::cannot_create, output.string(), "is what this is made of",
              "--output names another file");
}

}  // namespace ca2
