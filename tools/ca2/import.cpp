/// `ca2 import`: pictures and clouds of others as a session.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "core/io/cloud_files.h"
#include "core/io/read_picture.h"
#include "core/session/session.h"
#include "tools/ca2/command.h"
#include "tools/ca2/import_pairs.h"
#include "tools/ca2/progress.h"

namespace ca2 {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string folder, rig, output;
  double tolerance = 0.02;
  int every = 1;
};

/// What the rig names relative to its own file, wherever the session will be.
void make_absolute(Rig& rig, const fs::path& base) {
  for (auto& [name, lidar] : rig.lidars) {
    for (std::string* file : {&lidar.metadata, &lidar.calibration}) {
      if (!file->empty()) *file = fs::absolute(base / *file).lexically_normal().string();
    }
  }
}

Result<void> add_view(const fs::path& session, int id, const ImportGroup& group, const Rig& rig) {
  std::map<std::string, Image> images;
  std::map<std::string, Scan> scans;
  for (const auto& [sensor, file] : group) {
    if (rig.cameras.count(sensor)) {
      Result<Image> image = read_picture(file);
      if (!image) return fail(image.error());
      images[sensor] = std::move(*image);
    } else {
      Result<Scan> scan = read_cloud_file(file);
      if (!scan) return fail(scan.error());
      scans[sensor] = std::move(*scan);
    }
  }
  const Result<SessionView> written = write_view(session, id, images, scans);
  if (!written) return fail(written.error());
  return {};
}

Result<int> run_import(const Options& options) {
  Result<Rig> rig = read_rig(options.rig, {"software", "created", "start"});
  if (!rig) return fail(rig.error());
  make_absolute(*rig, fs::path(options.rig).parent_path());
  std::error_code error;
  if (!fs::is_directory(options.folder, error))
    return fail(ErrorCode::io, options.folder, "there is no such directory");
  const Result<ImportPlan> plan = plan_import(options.folder, *rig, options.tolerance);
  if (!plan) return fail(plan.error());
  if (plan->groups.empty()) {
    return fail(ErrorCode::data, options.folder, "no files of different sensors belong together",
                plan->timed ? "their time stamps are further apart than --tolerance"
                            : "give the files of a view the same number");
  }
  const Result<Session> session = create_session(options.output, *rig);
  if (!session) return fail(session.error());
  Progress progress("importing");
  int id = 0;
  std::vector<Problem> problems;
  for (std::size_t i = 0; i < plan->groups.size(); i += static_cast<std::size_t>(options.every)) {
    const Result<void> added = add_view(options.output, id + 1, plan->groups[i], *rig);
    if (added) {
      ++id;
    } else {
      problems.insert(problems.end(), added.error().problems.begin(), added.error().problems.end());
    }
    progress.show(static_cast<int>(i + 1), static_cast<int>(plan->groups.size()));
  }
  for (const Problem& problem : problems) {
    std::fprintf(stderr, "ca2: %s\n",
                 Error(ErrorCode::data, problem.where, "warning: left out: " + problem.what, problem.hint)
                     .text()
                     .c_str());
  }
  if (id == 0) return fail(ErrorCode::data, options.folder, "no view could be read");
  std::printf(
      "%d views paired by %s%s in %s\n", id, plan->timed ? "time" : "number",
      plan->single > 0 ? (", " + std::to_string(plan->single) + " files without a partner").c_str() : "",
      options.output.c_str());
  return 0;
}

}  // namespace

CommandBody setup_import(CLI::App& app) {
  auto options = std::make_shared<Options>();
  app.add_option("folder", options->folder, "Folder with pictures and clouds")
      ->required()
      ->type_name("FOLDER");
  app.add_option("--rig", options->rig, "YAML with the rig's keys: board, cameras, lidars")
      ->required()
      ->type_name("FILE");
  app.add_option("--output,-o", options->output, "Session to create")->required()->type_name("SESSION");
  app.add_option("--tolerance", options->tolerance, "Of time stamps in names, s")
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str();
  app.add_option("--every", options->every, "Take every N-th view only")
      ->check(CLI::Range(1, 1000000))
      ->type_name("N");
  app.footer(
      "Pictures (PNG, JPEG) and clouds (PCD, PLY, CSV, NPY) are looked for in FOLDER/<sensor>, at any depth; "
      "with one\n"
      "camera and one LiDAR, anywhere in FOLDER. What has the same number at the end of its name is a view: "
      "pose7.png\n"
      "and scan_0007.pcd. Numbers of 13 and more digits are times (ms, us, ns), as in Kalibr's and EuRoC's "
      "folders, and\n"
      "the nearest are taken. The board must have stood still: a moving one is for `ca2 replay`.");
  return [options] { return run_import(*options); };
}

}  // namespace ca2
