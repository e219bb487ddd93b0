#include "core/session/view_files.h"

#include <algorithm>

#include "core/io/files.h"
#include "core/io/yaml_reader.h"

namespace ca2 {
namespace {

namespace fs = std::filesystem;

constexpr long long max_pick = 1 << 20;  // rows and columns, as read_pcd
constexpr double max_pick_radius = 10000;

void read_details(const fs::path& file, const std::set<std::string>& lidars, SessionView& view,
                  std::vector<Problem>& warnings) {
  const auto give_up = [&](const Error& error) {
    for (Problem problem : error.problems) {
      problem.hint = "the view is used without view.yaml";
      warnings.push_back(std::move(problem));
    }
  };
  const Result<std::string> text = read_text(file, max_yaml_bytes);
  if (!text) return give_up(text.error());
  const Result<YamlNode> root = parse_yaml(*text, file.string(), ErrorCode::data);
  if (!root) return give_up(root.error());
  if (root->is_null()) return;
  YamlReader reader(file.string());
  if (reader.map(&*root, "the file",
                 {"version", "stamps", "frames", "scans", "trigger", "gates", "corners", "picks"})) {
    const YamlNode* picks = root->find("picks");
    for (const YamlNode& node : reader.map(picks, "picks") ? picks->items : std::vector<YamlNode>()) {
      if (!lidars.count(node.key)) {
        const std::vector<std::string_view> known(lidars.begin(), lidars.end());
        reader.key_problem(node, "there is no lidar '" + node.key + "'", suggest(node.key, known));
        continue;
      }
      if (!reader.map(&node, "a pick", {"row", "column", "radius"})) continue;
      const auto row = reader.integer(reader.require(node, "row", "the pick"), 0, max_pick);
      const auto column = reader.integer(reader.require(node, "column", "the pick"), 0, max_pick);
      const auto radius = reader.number(node.find("radius"), 0, max_pick_radius);
      if (!row || !column) continue;
      view.picks[node.key] = {static_cast<int>(*row), static_cast<int>(*column), radius.value_or(0)};
    }
  }
  warnings.insert(warnings.end(), reader.problems().begin(), reader.problems().end());
}

}  // namespace

std::string view_name(int id) {
  const std::string digits = std::to_string(id);
  return std::string(digits.size() < 6 ? 6 - digits.size() : 0, '0') + digits;
}

SessionView list_view(const fs::path& directory, int id, const std::set<std::string>& cameras,
                      const std::set<std::string>& lidars, std::vector<Problem>& warnings) {
  SessionView view;
  view.id = id;
  view.directory = directory;
  std::error_code error;
  std::vector<fs::path> files;
  for (fs::directory_iterator at(directory, error), end; !error && at != end; at.increment(error)) {
    files.push_back(at->path());
  }
  if (error) warnings.push_back({directory.string(), "cannot be listed: " + error.message(), {}});
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    const std::string name = file.filename().string(), sensor = file.stem().string(), kind = file.extension();
    if (name.front() == '.') continue;
    if (fs::is_other(file, error)) {  // reading a pipe would wait for ever
      warnings.push_back({file.string(), "is not a regular file: not used", {}});
    } else if (name == "view.yaml") {
      read_details(file, lidars, view, warnings);
    } else if (kind == ".png" && cameras.count(sensor)) {
      view.images[sensor] = file;
    } else if (kind == ".pcd" && lidars.count(sensor)) {
      view.clouds[sensor] = file;
    } else if (kind == ".png" || kind == ".pcd") {
      const auto& known = kind == ".png" ? cameras : lidars;
      const std::vector<std::string_view> names(known.begin(), known.end());
      warnings.push_back({file.string(),
                          std::string("the rig has no ") + (kind == ".png" ? "camera" : "lidar") + " '" +
                              sensor + "': the file is not used",
                          suggest(sensor, names)});
    } else {
      warnings.push_back({file.string(), "the file is not used", "views hold .png, .pcd and view.yaml"});
    }
  }
  return view;
}

}  // namespace ca2
