/// @file `ca2 report`: a solved session as a page to look at.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "core/io/files.h"
#include "core/io/jpeg.h"
#include "core/report/html_report.h"
#include "core/report/overlay.h"
#include "core/session/session.h"
#include "tools/ca2/command.h"
#include "tools/ca2/progress.h"

namespace ca2 {
namespace {

/// Larger sessions show this many views, evenly chosen, so that the page stays a page.
constexpr int max_views_shown = 12;

const CalibratedTransform* find_transform(const Calibration& calibration, const std::string& camera,
                                          const std::string& lidar) {
  for (const CalibratedTransform& transform : calibration.transforms) {
    if (transform.parent == camera && transform.child == lidar) return &transform;
  }
  return nullptr;
}

/// Views to show: used ones before rejected ones, evenly over the session.
std::vector<const SessionView*> choose_views(const Session& session, const Calibration& calibration) {
  std::vector<const SessionView*> used;
  for (const SessionView& view : session.views) {
    for (const CalibratedView& outcome : calibration.views) {
      if (outcome.id == view.id && outcome.used) used.push_back(&view);
    }
  }
  std::vector<const SessionView*> chosen;
  const std::size_t count = std::min<std::size_t>(used.size(), max_views_shown);
  for (std::size_t i = 0; i < count; ++i) chosen.push_back(used[i * used.size() / count]);
  return chosen;
}

Result<int> report(const std::string& directory) {
  const Result<Session> session = open_session(directory);
  if (!session) return fail(session.error());
  const std::filesystem::path result_file = session->directory / "result.yaml";
  if (!std::filesystem::exists(result_file)) {
    return fail(ErrorCode::data, result_file.string(), "the session has no result yet",
                "run `ca2 solve " + directory + "` first");
  }
  const Result<Calibration> calibration = read_calibration(result_file);
  if (!calibration) return fail(calibration.error());

  const std::filesystem::path folder = session->directory / "report";
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return fail(ErrorCode::cannot_create, folder.string(), error.message());

  ReportInput input;
  input.title = "Calibration of " + std::filesystem::weakly_canonical(session->directory).filename().string();
  input.calibration = *calibration;
  const std::vector<const SessionView*> views = choose_views(*session, *calibration);
  Progress progress("drawing");
  bool picture_written = false;
  for (std::size_t i = 0; i < views.size(); ++i) {
    for (const auto& [camera, image_file] : views[i]->images) {
      const auto model = calibration->cameras.find(camera);
      const Result<Image> image = read_png(image_file);
      for (const auto& [lidar, cloud_file] : views[i]->clouds) {
        const CalibratedTransform* transform = find_transform(*calibration, camera, lidar);
        if (!transform || model == calibration->cameras.end()) continue;
        const Result<Scan> scan = read_pcd(cloud_file);
        if (!image || !scan) {
          for (const Problem& problem : (image ? scan.error() : image.error()).problems)
            input.problems.push_back(problem);
          continue;
        }
        const Overlay overlay = draw_overlay(*image, model->second.camera, *scan, transform->T_parent_child);
        const Result<std::string> jpeg = encode_jpeg(overlay.image, 82);
        if (!jpeg) return fail(jpeg.error());
        input.pictures.push_back({views[i]->id, camera, lidar, *jpeg, overlay.near, overlay.far});
        if (!picture_written) {
          const Result<void> written = write_png(folder / "overlay.png", overlay.image);
          if (!written) return fail(written.error());
          picture_written = true;
        }
      }
    }
    progress.show(static_cast<int>(i + 1), static_cast<int>(views.size()));
  }
  const Result<void> written = write_atomically(folder / "index.html", html_report(input));
  if (!written) return fail(written.error());
  std::printf("%s\n", (folder / "index.html").string().c_str());
  if (picture_written) std::printf("%s\n", (folder / "overlay.png").string().c_str());
  return 0;
}

}  // namespace

CommandBody setup_report(CLI::App& app) {
  auto session = std::make_shared<std::string>();
  app.add_option("session", *session, "Session directory, solved")->required();
  app.footer(
      "Writes SESSION/report/index.html: verdict, extrinsics with sigma, residuals of every view and the "
      "LiDAR's points on\n"
      "the pictures, in one file to open in any browser; and SESSION/report/overlay.png.");
  return [session] { return report(*session); };
}

}  // namespace ca2
