/// `ca2 intrinsics`: a camera calibrated alone, from a session or from a folder of pictures.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/export/exporter.h"
#include "core/intrinsics/validate_intrinsics.h"
#include "core/io/files.h"
#include "core/io/yaml_text.h"
#include "core/types/counted.h"
#include "core/types/text.h"
#include "tools/ca2/command.h"
#include "tools/ca2/input_files.h"
#include "tools/ca2/picture_corners.h"
#include "tools/ca2/progress.h"

namespace ca2 {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string source, board, camera, model = "all", output, format = "camera_info";
  bool json = false;
};

/// Six cells each way: how often a corner fell there. What is empty is where the board should go next.
std::string coverage_map(const PictureCorners& pictures) {
  constexpr int cells = 6;
  int count[cells][cells] = {};
  for (const auto& corners : pictures.corners) {
    for (const Corner& corner : corners) {
      const auto cell = [](double at, int size) {
        return std::clamp(static_cast<int>(cells * (at + 0.5) / size), 0, cells - 1);
      };
      ++count[cell(corner.pixel.y(), pictures.height)][cell(corner.pixel.x(), pictures.width)];
    }
  }
  std::string out = "corners seen, by part of the picture:\n";
  for (const auto& row : count) {
    for (const int n : row) out += formatted(" %5d", n);
    out += '\n';
  }
  return out;
}

std::string describe(const IntrinsicsTrial& best, const PictureCorners& pictures) {
  const IntrinsicsEstimate& e = *best.estimate;
  std::string out = formatted("%s, %d x %d\n", best.model.c_str(), e.camera.width, e.camera.height);
  for (Eigen::Index k = 0; k < e.camera.parameters.size(); ++k) {
    out += formatted("  %-6s %14.8g +- %.2g\n",
                     std::string(e.camera.model->parameter_names()[static_cast<std::size_t>(k)]).c_str(),
                     e.camera.parameters(k), std::sqrt(e.covariance(k, k)));
  }
  const auto used = std::count_if(e.views.begin(), e.views.end(), [](const auto& view) { return view.used; });
  out +=
      formatted("%ld of %s used; reprojection %.4f px rms; a known ray's pixel is off by %.3f px (1 sigma)\n",
                static_cast<long>(used), counted(e.views.size(), "picture").c_str(), e.reprojection_rms,
                e.projection_sigma);
  for (std::size_t i = 0; i < e.views.size(); ++i) {
    if (!e.views[i].used) out += "  " + pictures.names[i] + " not used: " + e.views[i].reason + "\n";
  }
  return out + coverage_map(pictures);
}

std::string table(const std::vector<IntrinsicsTrial>& trials, const IntrinsicsTrial* best) {
  std::string out = "model             fit, px   on pictures kept from the fit, px\n";
  for (const IntrinsicsTrial& trial : trials) {
    out += formatted("%-16s", trial.model.c_str());
    if (!trial.estimate) {
      out += "  " + trial.estimate.error().problems.front().what + "\n";
      continue;
    }
    out += formatted("%9.4f", trial.estimate->reprojection_rms);
    out += trial.held_out ? formatted("   %.4f", *trial.held_out) : std::string("   too few pictures");
    out += &trial == best ? "  <- taken\n" : "\n";
  }
  return out;
}

nlohmann::ordered_json to_json(const std::string& camera, const IntrinsicsTrial& best,
                               const PictureCorners& pictures) {
  const IntrinsicsEstimate& e = *best.estimate;
  const auto size = e.covariance.rows();
  std::vector<double> covariance;
  for (Eigen::Index i = 0; i < size * size; ++i) covariance.push_back(e.covariance(i / size, i % size));
  auto views = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < e.views.size(); ++i) {
    views.push_back({{"name", pictures.names[i]},
                     {"used", e.views[i].used},
                     {"reason", e.views[i].reason},
                     {"reprojection_rms_px", e.views[i].reprojection_rms}});
  }
  return {
      {"camera", camera},
      {"model", best.model},
      {"image_size", {e.camera.width, e.camera.height}},
      {"parameters", std::vector<double>(e.camera.parameters.begin(), e.camera.parameters.end())},
      {"covariance", covariance},
      {"reprojection_rms_px", e.reprojection_rms},
      {"held_out_rms_px", best.held_out ? nlohmann::ordered_json(*best.held_out) : nlohmann::ordered_json()},
      {"projection_sigma_px", e.projection_sigma},
      {"views", views}};
}

/// The file of one camera, by the exporters: what they refuse is refused here.
Result<std::string> file_of(const std::string& camera, const IntrinsicsEstimate& estimate,
                            const Options& options) {
  if (options.format == "session") {
    const CameraParameters& p = estimate.camera.parameters;
    return "# to paste in session.yaml under cameras:\n" + camera + ":\n  image_size: [" +
           std::to_string(estimate.camera.width) + ", " + std::to_string(estimate.camera.height) +
           "]\n  intrinsics: {model: " + std::string(estimate.camera.model->name()) +
           ", parameters: " + exact_list(p) + "}\n";
  }
  ExportRequest request;
  request.calibration.software = "ca2 intrinsics";
  request.calibration.method = "intrinsics";
  request.calibration.observability.verdict = "good";
  request.calibration.cameras[camera] = {estimate.camera, true, {}};
  request.session = options.source;
  for (const IntrinsicsView& view : estimate.views)
    request.calibration.views.push_back({0, view.used, view.reason, 0, 0});
  Result<FrameGraph> frames = FrameGraph::of(request.calibration);
  if (!frames) return fail(frames.error());
  request.frames = std::move(*frames);
  const Result<ExportFiles> files = find_exporter(options.format)->write(request);
  if (!files) return fail(files.error());
  return files->front().content;
}

Result<int> run(const Options& options) {
  const std::filesystem::path rig = std::filesystem::path(options.source) / "session.yaml";
  if (const auto spared = spare_inputs(options.output, {rig, options.board}); !spared)
    return fail(spared.error());
  Progress progress("finding the board");
  Result<std::vector<PictureCorners>> cameras = read_corners(
      options.source, options.board, options.camera, [&](int done, int all) { progress.show(done, all); });
  if (!cameras) return fail(cameras.error());
  if (!options.output.empty() && cameras->size() > 1) {
    return fail(ErrorCode::usage, "--output", "is one file, and there are several cameras",
                "name one with --camera");
  }
  std::vector<std::string> models;
  for (const CameraModel* model : camera_models()) {
    if (options.model == "all" || options.model == model->name()) models.emplace_back(model->name());
  }
  auto json = nlohmann::ordered_json::array();
  for (const PictureCorners& pictures : *cameras) {
    const auto trials = try_models(pictures.board, pictures.width, pictures.height, models, pictures.corners);
    const IntrinsicsTrial* best = best_trial(trials);
    if (!best) {
      Error error = trials.front().estimate.error();
      for (Problem& problem : error.problems)
        problem.where = pictures.camera + (problem.where.empty() ? "" : ": " + problem.where);
      return fail(std::move(error));
    }
    if (!options.output.empty()) {
      const Result<std::string> file = file_of(pictures.camera, *best->estimate, options);
      if (!file) return fail(file.error());
      if (const auto written = write_atomically(options.output, *file); !written)
        return fail(written.error());
    }
    if (options.json) {
      json.push_back(to_json(pictures.camera, *best, pictures));
    } else {
      std::printf("camera %s: %s%s", pictures.camera.c_str(), describe(*best, pictures).c_str(),
                  table(trials, best).c_str());
      if (!options.output.empty()) std::printf("written to %s\n", options.output.c_str());
    }
  }
  if (options.json)
    std::printf("%s\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
  return 0;
}

}  // namespace

CommandBody setup_intrinsics(CLI::App& app) {
  auto options = std::make_shared<Options>();
  std::vector<std::string> models{"all"};
  for (const CameraModel* model : camera_models()) models.emplace_back(model->name());
  app.add_option("source", options->source, "Session, or folder of PNG and JPEG pictures of one camera")
      ->required()
      ->type_name("SESSION|FOLDER");
  app.add_option("--board", options->board, "Of a folder: the YAML that ca2 board wrote, or any rig's")
      ->type_name("FILE");
  app.add_option("--camera", options->camera,
                 "Of a session: this camera only; of a folder: its name (default: camera)");
  app.add_option("--model", options->model, "all: try each and take what foretells unseen pictures best")
      ->check(CLI::IsMember(models))
      ->capture_default_str();
  app.add_option("--output,-o", options->output, "Write the intrinsics to this file")->type_name("FILE");
  app.add_option("--format", options->format, "Of the file; session: the keys of session.yaml")
      ->check(CLI::IsMember({"camera_info", "kalibr", "opencv", "session"}))
      ->capture_default_str();
  app.add_flag("--json", options->json, "Print the answer, with covariance, as JSON");
  app.footer(
      "Twenty pictures with the board in every part of the picture, tilted to every side by 20 to 40 "
      "degrees, are\n"
      "plenty. Exit status 1 when the pictures do not determine the camera: the message says what to show.");
  return [options] { return run(*options); };
}

}  // namespace ca2
