/// `ca2 check FILE...`: what a file is, whether it is sound, and every problem with its place.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/features/result_inputs.h"
#include "core/features/search.h"
#include "core/io/files.h"
#include "core/io/yaml.h"
#include "core/session/calibration.h"
#include "core/session/rig.h"
#include "core/session/session.h"
#include "core/types/counted.h"
#include "drivers/recording/recording_reader.h"
#include "tools/ca2/command.h"
#include "tools/ca2/lidar_file.h"
#include "tools/ca2/picture_corners.h"
#include "tools/ca2/rig_doubts.h"
#include "tools/sim/scenario_file.h"
#include "tools/sim/truth_file.h"

namespace ca2 {
namespace {

namespace fs = std::filesystem;

/// What was found out about one file or directory.
struct Finding {
  std::string kind;
  std::string summary;
  std::vector<Problem> problems;
  ErrorCode code = ErrorCode::data;  ///< of the gravest problem
  std::vector<Problem> warnings;

  void add(const Error& error) {
    // The higher code is the graver: data 65, I/O 74, configuration 78.
    code = problems.empty() ? error.code : std::max(code, error.code);
    problems.insert(problems.end(), error.problems.begin(), error.problems.end());
  }
};

std::string size_text(const Image& image) {
  return std::to_string(image.width) + " x " + std::to_string(image.height);
}

std::string image_text(const Image& image) {
  return size_text(image) + ", " + std::to_string(image.bits) + " bit " +
         (image.channels == 3 ? "colour" : "grey");
}

std::string scan_text(const Scan& scan) {
  const std::size_t valid = scan.returns();
  std::string text = counted(scan.size(), "point");
  if (valid != scan.size()) text += ", " + std::to_string(valid) + " of them returns";
  if (scan.rings > 0) text += ", " + counted(scan.rings, "ring");
  if (scan.columns > 0) text += ", " + counted(scan.columns, "column");
  return text;
}

std::string board_text(const Board& board) {
  return std::string(board.type->name()) + " " + std::to_string(board.columns) + " x " +
         std::to_string(board.rows);
}

std::string rig_text(const Rig& rig) {
  const auto names = [](const auto& sensors) {
    std::string list;
    for (const auto& [name, sensor] : sensors) list += (list.empty() ? "" : " ") + name;
    return std::to_string(sensors.size()) + " (" + list + ")";
  };
  return board_text(rig.board) + ", cameras: " + names(rig.cameras) + ", lidars: " + names(rig.lidars);
}

template <class Value, class Describe>
void take(Finding& finding, const Result<Value>& result, Describe describe) {
  if (result) {
    finding.summary = describe(*result);
  } else {
    finding.add(result.error());
  }
}

/// Every picture and cloud of a view, and whether they fit the rig.
void check_view(const SessionView& view, const Rig& rig, Finding& finding) {
  for (const auto& [name, file] : view.images) {
    const Result<Image> image = read_png(file);
    if (!image) {
      finding.add(image.error());
      continue;
    }
    const RigCamera& camera = rig.cameras.at(name);
    if (camera.width != 0 && (camera.width != image->width || camera.height != image->height)) {
      finding.add(Error(ErrorCode::data, file.string(),
                        "the picture is " + size_text(*image) + ", the rig says " +
                            std::to_string(camera.width) + " x " + std::to_string(camera.height),
                        "correct image_size (and the intrinsics), or use the camera's own pictures"));
    }
  }
  for (const auto& [name, file] : view.clouds) {
    if (const Result<Scan> scan = read_cloud(file); !scan) finding.add(scan.error());
  }
}

Finding check_session(const fs::path& directory) {
  Finding finding{"session", {}, {}, ErrorCode::data, {}};
  const Result<Session> session = open_session(directory);
  if (!session) {
    finding.add(session.error());
    return finding;
  }
  finding.summary = counted(session->views.size(), "view") + "; " + rig_text(session->rig);
  finding.warnings = rig_doubts(session->rig, (directory / "session.yaml").string());
  finding.warnings.insert(finding.warnings.end(), session->warnings.begin(), session->warnings.end());
  if (session->views.empty()) {
    finding.warnings.push_back({(directory / "views").string(), "there are no views yet", {}});
  }
  for (const SessionView& view : session->views) check_view(view, session->rig, finding);
  const fs::path result = directory / "result.yaml";
  if (fs::exists(result)) {
    const auto calibration = read_calibration(result);
    if (!calibration) {
      finding.add(calibration.error());
    } else if (auto outdated = outdated_result(*calibration, *session)) {
      finding.warnings.push_back(std::move(*outdated));
    }
  }
  return finding;
}

/// What replaying would read, from its first pictures and packets on.
Finding check_recording(const fs::path& directory) {
  Finding finding{"recording", {}, {}, ErrorCode::data, {}};
  const Result<Recording> recording = open_recording(directory);
  take(finding, recording, [](const Recording& found) { return rig_text(found.rig); });
  if (!recording) return finding;
  const Result<RecordingReader> reader = RecordingReader::open(*recording);
  if (!reader) {
    finding.add(reader.error());
    return finding;
  }
  finding.summary = counted(reader->pictures(), "picture") + "; " + finding.summary;
  finding.warnings = reader->warnings();
  return finding;
}

std::string calibration_text(const Calibration& calibration) {
  return counted(calibration.transforms.size(), "transform") + " by " + calibration.method + ", " +
         counted(calibration.views.size(), "view");
}

Finding check_yaml(const fs::path& file, const std::string& text) {
  Finding finding{"YAML file", {}, {}, ErrorCode::data, {}};
  const std::string name = file.filename().string();
  // Calibrations of others (OpenCV's begin with a line that is no YAML) are told apart by their own reader.
  const Result<YamlNode> root = parse_yaml(text, file.string());
  const auto has = [&](const char* key) { return root && root->find(key); };
  if (has("scene") || has("truth")) {
    finding.kind = "scenario";
    take(finding, read_scenario(file), [](const ScenarioFile& scenario) {
      return counted(scenario.scenario.views, "view") + " of " + rig_text(scenario.rig);
    });
  } else if (has("scenario")) {
    finding.kind = "truth";
    take(finding, read_true_transforms(file),
         [](const std::vector<TrueTransform>& truth) { return counted(truth.size(), "transform"); });
  } else if (has("transforms") || name == "result.yaml") {
    finding.kind = "result";
    take(finding, parse_calibration(text, file.string()), calibration_text);
  } else if (name == "recording.yaml") {
    finding.kind = "recording";
    take(finding, open_recording(file.parent_path()),
         [](const Recording& recording) { return rig_text(recording.rig); });
  } else if (has("board") && root->items.size() == 1) {
    finding.kind = "board";
    take(finding, read_board(file), board_text);
  } else if (has("board") || has("cameras") || has("lidars") || name == "session.yaml") {
    finding.kind = name == "session.yaml" ? "session.yaml" : "rig";
    const Result<Rig> rig = parse_rig(text, file, {"software", "created"});
    take(finding, rig, rig_text);
    if (rig) finding.warnings = rig_doubts(*rig, file.string());
  } else {
    finding.kind = "camera intrinsics";
    const Result<Camera> intrinsics = read_intrinsics(file);
    take(finding, intrinsics, [](const Camera& camera) {
      return std::string(camera.model->name()) + ", " + std::to_string(camera.width) + " x " +
             std::to_string(camera.height);
    });
    if (auto doubt = intrinsics ? camera_doubt(*intrinsics, file.string()) : std::nullopt) {
      finding.warnings.push_back(std::move(*doubt));
    }
  }
  return finding;
}

Finding check_directory(const fs::path& directory) {
  return fs::exists(directory / "recording.yaml") ? check_recording(directory) : check_session(directory);
}

Finding check_file(const fs::path& file) {
  std::error_code error;
  if (fs::is_directory(file, error)) return check_directory(file);
  const std::string extension = file.extension().string();
  Finding finding{"file", {}, {}, ErrorCode::data, {}};
  if (extension == ".png") {
    finding.kind = "PNG picture";
    take(finding, read_png(file), image_text);
    return finding;
  }
  if (extension == ".pcd") {
    finding.kind = "PCD cloud";
    take(finding, read_cloud(file), scan_text);
    return finding;
  }
  const Result<std::string> text = read_text(file, max_yaml_bytes);
  if (!text) {
    finding.add(text.error());
    return finding;
  }
  if (auto lidar = look_at_lidar_file(file, *text)) {
    finding.kind = std::move(lidar->kind);
    finding.warnings = std::move(lidar->warnings);
    take(finding, lidar->summary, [](const std::string& summary) { return summary; });
    return finding;
  }
  return check_yaml(file, *text);
}

nlohmann::ordered_json to_json(const std::vector<Problem>& problems) {
  auto list = nlohmann::ordered_json::array();
  for (const Problem& problem : problems) {
    list.push_back({{"where", problem.where}, {"what", problem.what}, {"hint", problem.hint}});
  }
  return list;
}

void print(const std::vector<Problem>& problems, const char* prefix) {
  for (const Problem& problem : problems) {
    std::fprintf(stderr, "ca2: %s%s%s%s%s%s\n", problem.where.c_str(), problem.where.empty() ? "" : ": ",
                 prefix, problem.what.c_str(), problem.hint.empty() ? "" : "; ", problem.hint.c_str());
  }
}

struct CheckOptions {
  std::vector<std::string> files;
  bool json = false;
};

int run_check(const CheckOptions& options) {
  int exit_code = 0;
  auto json = nlohmann::ordered_json::array();
  for (const std::string& file : options.files) {
    const Finding finding = check_file(file);
    const bool sound = finding.problems.empty();
    if (!sound) exit_code = std::max(exit_code, static_cast<int>(finding.code));
    print(finding.problems, "");
    print(finding.warnings, "warning: ");
    if (options.json) {
      json.push_back({{"file", file},
                      {"kind", finding.kind},
                      {"ok", sound},
                      {"summary", finding.summary},
                      {"problems", to_json(finding.problems)},
                      {"warnings", to_json(finding.warnings)}});
    } else if (sound) {
      std::printf("%s: %s, sound: %s\n", file.c_str(), finding.kind.c_str(), finding.summary.c_str());
    } else {
      std::printf("%s: %s, %s\n", file.c_str(), finding.kind.c_str(),
                  counted(finding.problems.size(), "problem").c_str());
    }
  }
  if (options.json) {
    std::printf("%s\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
  }
  return exit_code;
}

}  // namespace

CommandBody setup_check(CLI::App& app) {
  auto options = std::make_shared<CheckOptions>();
  app.add_option("FILE", options->files,
                 "Rig, board, session (directory or session.yaml), recording, result, scenario, PNG, PCD, "
                 "camera intrinsics")
      ->required();
  app.add_flag("--json", options->json, "Print the findings as JSON");
  app.footer(
      "A session's directory is checked with all its pictures and clouds, a recording's with what its "
      "sensors\n"
      "begin with. Problems go to stderr. Exit status:\n"
      "0 sound (there may be warnings), 65 bad data, 74 cannot be read, 78 bad configuration; the highest of "
      "all.");
  return [options]() -> Result<int> { return run_check(*options); };
}

}  // namespace ca2
