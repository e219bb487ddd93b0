/// `ca2 export`: a result in the files that robots read.
#include "core/export/exporter.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>

#include "core/export/known_frames.h"
#include "core/features/result_inputs.h"
#include "core/io/files.h"
#include "core/session/calibration.h"
#include "core/session/session.h"
#include "tools/ca2/command.h"
#include "tools/ca2/input_files.h"
#include "tools/ca2/print_warnings.h"
#include "tools/ca2/provenance.h"

namespace ca2 {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string session, format, parent, output;
  std::vector<std::string> children, via;
};

/// --via: FILE with known transforms, LINK=CAMERA, or CAMERA when --parent or --child is its link.
Result<void> add_known(FrameGraph& frames, const Options& options) {
  std::error_code error;
  for (const std::string& via : options.via) {
    if (fs::is_regular_file(via, error)) {
      const auto known = read_known_frames(via);
      if (!known) return fail(known.error());
      for (const FrameTransform& transform : *known) {
        if (const auto added = frames.add(transform, via); !added) return fail(added.error());
      }
      continue;
    }
    if (const std::size_t equals = via.find('='); equals != std::string::npos && equals > 0) {
      const auto added = frames.add_link(via.substr(0, equals), via.substr(equals + 1));
      if (!added) return fail(added.error());
      continue;
    }
    if (!frames.knows(via)) {
      return fail(ErrorCode::usage, "--via " + via,
                  "is neither a file, nor LINK=CAMERA, nor a sensor or frame", "known are: " + frames.list());
    }
  }
  frames.connect_links();
  for (const std::string& via : options.via) {
    if (!frames.is_camera(via)) continue;
    std::vector<std::string> ends = options.children;
    ends.push_back(options.parent);
    for (const std::string& end : ends) {
      if (end.empty() || frames.knows(end)) continue;
      if (const auto added = frames.add_link(end, via); !added) return fail(added.error());
    }
  }
  return {};
}

Result<void> write_files(const ExportFiles& files, const fs::path& output,
                         const std::vector<fs::path>& inputs) {
  std::error_code error;
  // A name with an ending is a file where there is one file to write; else it is the directory of them.
  if (files.size() == 1 && output.has_extension() && !fs::is_directory(output, error)) {
    if (auto spared = spare_inputs(output, inputs); !spared) return spared;
    const auto written = write_atomically(output, files.front().content);
    if (written) std::printf("%s\n", output.string().c_str());
    return written;
  }
  fs::create_directories(output, error);
  if (error) return fail(ErrorCode::cannot_create, output.string(), error.message());
  for (const ExportFile& file : files) {
    if (auto spared = spare_inputs(output / file.name, inputs); !spared) return spared;
  }
  for (const ExportFile& file : files) {
    const auto written = write_atomically(output / file.name, file.content);
    if (!written) return written;
    std::printf("%s\n", (output / file.name).string().c_str());
  }
  return {};
}

/// Several files are told apart by a line that is a comment in all the formats with several.
void print_files(const ExportFiles& files) {
  const auto shown =
      std::count_if(files.begin(), files.end(), [](const ExportFile& file) { return file.main; });
  for (const ExportFile& file : files) {
    if (!file.main) continue;
    if (shown > 1) std::printf("%s# file: %s\n", &file == &files.front() ? "" : "---\n", file.name.c_str());
    std::fwrite(file.content.data(), 1, file.content.size(), stdout);
  }
}

Result<int> run_export(const Options& options) {
  const Exporter* exporter = find_exporter(options.format);
  const Result<Session> session = open_session(options.session);
  if (!session) return fail(session.error());
  const fs::path file = session->directory / "result.yaml";
  if (!fs::exists(file)) {
    return fail(ErrorCode::data, file.string(), "the session has no result yet",
                "run `ca2 solve " + options.session + "` first");
  }
  const Result<Calibration> calibration = read_calibration(file);
  if (!calibration) return fail(calibration.error());
  Result<FrameGraph> frames = FrameGraph::of(*calibration);
  if (!frames) return fail(frames.error());
  if (const auto added = add_known(*frames, options); !added) return fail(added.error());
  if (const auto outdated = outdated_result(*calibration, *session)) print_warnings({*outdated});
  if (calibration->observability.verdict != "good") {
    std::fprintf(stderr, "ca2: %s: warning: the verdict is '%s'; more views would make this better: %s\n",
                 file.string().c_str(), calibration->observability.verdict.c_str(),
                 calibration->observability.weakest_direction.c_str());
  }
  const Result<ExportFiles> files = exporter->write({*calibration, *frames, options.parent, options.children,
                                                     session_name(session->directory), provenance(*session)});
  if (!files) return fail(files.error());
  if (options.output.empty()) {
    print_files(*files);
  } else {
    // A robot's description that is to get the calibration is not to be replaced by it.
    std::vector<fs::path> inputs = input_files(*session);
    inputs.push_back(file);
    inputs.insert(inputs.end(), options.via.begin(), options.via.end());
    if (const auto written = write_files(*files, options.output, inputs); !written) {
      return fail(written.error());
    }
  }
  return 0;
}

}  // namespace

CommandBody setup_export(CLI::App& app) {
  auto options = std::make_shared<Options>();
  std::vector<std::string> names;
  std::string list;
  for (const Exporter& exporter : exporters()) {
    names.emplace_back(exporter.name);
    list += "  " + std::string(exporter.name) + std::string(13 - exporter.name.size(), ' ') +
            std::string(exporter.help) + "\n";
  }
  app.add_option("session", options->session, "Session directory, solved")->required();
  app.add_option("--format", options->format, "Which software is to read it, see below")
      ->required()
      ->check(CLI::IsMember(names));
  app.add_option("--parent", options->parent,
                 "Sensor or frame the poses are relative to (default: the first camera; autoware: the first "
                 "LiDAR). camera_info, kalibr, opencv: the camera to write (default: all)")
      ->type_name("FRAME");
  app.add_option("--child", options->children,
                 "Sensor or frame whose pose is wanted; may be repeated (default: all)")
      ->type_name("FRAME")
      ->allow_extra_args(false);
  app.add_option(
         "--via", options->via,
         "What leads there: a URDF, a YAML file with `extrinsics:`, LINK=CAMERA, or the CAMERA whose link "
         "--parent or --child is; may be repeated")
      ->type_name("FILE|LINK=CAMERA|CAMERA")
      ->allow_extra_args(false);
  app.add_option("--output,-o", options->output, "Write into this directory, or file where there is but one")
      ->type_name("PATH");
  app.footer(
      "Formats:\n" + list +
      "T_parent_child is the pose of the child in its parent: it maps points of the child to the parent. A\n"
      "camera's frame is optical (x right, y down, z forward); its NAME_link (x forward, y left, z up) is\n"
      "known by its name. What a format cannot express is refused (exit status 1), never rounded or left "
      "out.\n"
      "A session whose views or rig changed since it was solved is exported with a warning.");
  return [options] { return run_export(*options); };
}

}  // namespace ca2
