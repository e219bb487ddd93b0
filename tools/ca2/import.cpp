/// `ca2 import`: pictures and clouds of others, in folders or LCM logs, as a session.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>

#include "core/io/cloud_files.h"
#include "core/io/read_picture.h"
#include "core/session/session.h"
#include "core/types/counted.h"
#include "tools/ca2/command.h"
#include "tools/ca2/import_log.h"
#include "tools/ca2/import_pairs.h"
#include "tools/ca2/kalibr_rig.h"
#include "tools/ca2/number_in.h"
#include "tools/ca2/print_warnings.h"
#include "tools/ca2/progress.h"

namespace ca2 {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string from, rig, target, camchain, output;
  std::vector<std::string> lidars, channels;
  double tolerance = 0.02;
  int every = 1;
};

/// What is to become a session: how many views there are, and how one is loaded.
struct Source {
  std::size_t views = 0;
  std::string paired;      ///< "time" or "number"
  std::size_t single = 0;  ///< files or messages without a partner
  std::function<Result<void>(std::size_t view, std::map<std::string, Image>&, std::map<std::string, Scan>&)>
      load;
};

/// What the rig names relative to its own file, wherever the session will be.
void make_absolute(Rig& rig, const fs::path& base) {
  for (auto& [name, lidar] : rig.lidars) {
    for (std::string* file : {&lidar.metadata, &lidar.calibration}) {
      if (!file->empty()) *file = fs::absolute(base / *file).lexically_normal().string();
    }
  }
}

Result<Rig> rig_of(const Options& options) {
  if (!options.target.empty()) {
    if (options.camchain.empty())
      return fail(ErrorCode::usage, "--target", "needs --camchain", "or describe the rig in a file: --rig");
    return kalibr_rig(options.target, options.camchain, options.lidars);
  }
  if (options.rig.empty()) {
    return fail(ErrorCode::usage, "", "which sensors and which board?",
                "give --rig FILE, or Kalibr's --target and --camchain, and --lidar NAME");
  }
  Result<Rig> rig = read_rig(options.rig, {"software", "created", "start"});
  if (rig) make_absolute(*rig, fs::path(options.rig).parent_path());
  return rig;
}

Result<void> load_files(const ImportGroup& group, const Rig& rig, std::map<std::string, Image>& images,
                        std::map<std::string, Scan>& scans) {
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
  return {};
}

Result<Source> folder_source(const Options& options, const Rig& rig) {
  if (!options.channels.empty()) return fail(ErrorCode::usage, "--channel", "is for logs", "leave it out");
  Result<ImportPlan> plan = plan_import(options.from, rig, options.tolerance);
  if (!plan) return fail(plan.error());
  if (plan->groups.empty()) {
    return fail(ErrorCode::data, options.from, "no files of different sensors belong together",
                plan->timed ? "their time stamps are further apart than --tolerance"
                            : "give the files of a view the same number");
  }
  Source source{plan->groups.size(), plan->timed ? "time" : "number", plan->single, {}};
  source.load = [groups = std::move(plan->groups), &rig](std::size_t view, auto& images, auto& scans) {
    return load_files(groups[view], rig, images, scans);
  };
  return source;
}

Result<Source> log_source(const Options& options, const Rig& rig) {
  std::map<std::string, std::string> channels;
  for (const std::string& channel : options.channels) {
    const std::size_t at = channel.find('=');
    if (at == std::string::npos || !channels.emplace(channel.substr(0, at), channel.substr(at + 1)).second)
      return fail(ErrorCode::usage, "--channel " + channel, "is not SENSOR=CHANNEL, once per sensor");
  }
  Result<LogPlan> plan = plan_log(options.from, rig, channels, options.tolerance);
  if (!plan) return fail(plan.error());
  if (plan->groups.empty()) {
    return fail(ErrorCode::data, options.from, "no messages of different sensors belong together",
                "their times are further apart than --tolerance");
  }
  Source source{plan->groups.size(), "time", plan->single, {}};
  source.load = [groups = std::move(plan->groups), &rig, file = options.from](std::size_t view, auto& images,
                                                                              auto& scans) {
    return load_log_view(file, groups[view], rig, images, scans);
  };
  return source;
}

Result<int> run_import(const Options& options) {
  const Result<Rig> rig = rig_of(options);
  if (!rig) return fail(rig.error());
  std::error_code error;
  const bool folder = fs::is_directory(options.from, error);
  if (!folder && !fs::is_regular_file(options.from, error))
    return fail(ErrorCode::io, options.from, "there is no such directory or log");
  const Result<Source> source = folder ? folder_source(options, *rig) : log_source(options, *rig);
  if (!source) return fail(source.error());
  const Result<Session> session = create_session(options.output, *rig);
  if (!session) return fail(session.error());
  Progress progress("importing");
  int id = 0;
  std::vector<Problem> problems;
  for (std::size_t i = 0; i < source->views; i += static_cast<std::size_t>(options.every)) {
    std::map<std::string, Image> images;
    std::map<std::string, Scan> scans;
    Result<void> loaded = source->load(i, images, scans);
    if (loaded) {
      const Result<SessionView> written = write_view(options.output, id + 1, images, scans);
      if (!written) return fail(written.error());
      ++id;
    } else {
      for (const Problem& problem : loaded.error().problems)
        problems.push_back({problem.where, "left out: " + problem.what, problem.hint});
    }
    progress.show(static_cast<int>(i + 1), static_cast<int>(source->views));
  }
  print_warnings(problems);
  if (id == 0) return fail(ErrorCode::data, options.from, "no view could be read");
  std::printf(
      "%s paired by %s%s in %s\n", counted(id, "view").c_str(), source->paired.c_str(),
      source->single > 0
          ? (", " + counted(source->single, folder ? "file" : "message") + " without a partner").c_str()
          : "",
      options.output.c_str());
  return 0;
}

}  // namespace

CommandBody setup_import(CLI::App& app) {
  auto options = std::make_shared<Options>();
  app.add_option("from", options->from, "Folder with pictures and clouds, or an LCM log")
      ->required()
      ->type_name("FOLDER|LOG");
  app.add_option("--rig", options->rig, "YAML with the rig's keys: board, cameras, lidars")
      ->type_name("FILE");
  app.add_option("--target", options->target, "Instead of --rig: Kalibr's target, for the board")
      ->type_name("FILE")
      ->excludes("--rig");
  app.add_option("--camchain", options->camchain,
                 "With --target: Kalibr's result, for the cameras cam0, cam1, ...")
      ->type_name("FILE")
      ->needs("--target");
  app.add_option("--lidar", options->lidars, "With --target: name of a LiDAR; repeatable")
      ->type_name("NAME")
      ->needs("--target");
  app.add_option("--channel", options->channels, "Of a log: which channel is a sensor's; repeatable")
      ->type_name("SENSOR=CHANNEL");
  app.add_option("--output,-o", options->output, "Session to create")->required()->type_name("SESSION");
  app.add_option("--tolerance", options->tolerance, "Of times in names and messages, s")
      ->check(number_in(0, 10))
      ->capture_default_str();
  app.add_option("--every", options->every, "Take every N-th view only")
      ->check(number_in(1, 1000000))
      ->type_name("N");
  app.footer(
      "Pictures (PNG, JPEG) and clouds (PCD, PLY, CSV, NPY) are looked for in FOLDER/<sensor>, at any depth; "
      "with one\n"
      "camera and one LiDAR, anywhere in FOLDER. What has the same number at the end of its name is a view: "
      "pose7.png\n"
      "and scan_0007.pcd. Numbers of 13 and more digits are times (ms, us, ns), as in Kalibr's and EuRoC's "
      "folders, and\n"
      "the nearest are taken. Of a log, bot_core.image_t, pointcloud_t and pointcloud2_t are read. The board "
      "must have\n"
      "stood still: a moving one is for `ca2 replay`. /usr/share/doc/ca2/import.md tells more.");
  return [options] { return run_import(*options); };
}

}  // namespace ca2
