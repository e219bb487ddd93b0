#include "tools/ca2/report_pictures.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <thread>

#include "core/io/files.h"
#include "core/io/jpeg.h"
#include "core/report/overlay.h"

namespace ca2 {
namespace {

/// A camera and a LiDAR in a view.
struct Job {
  int view = 0;
  std::string camera, lidar;
  std::filesystem::path image, cloud;
  const Camera* model = nullptr;
  Pose T_camera_lidar;
  double range_sigma = 0;  ///< m
};

struct Drawn {
  ReportPicture picture;
  std::vector<Problem> problems;
  std::string cloud, ply;
  Image overlay;
};

std::vector<Job> list_jobs(const Session& session, const Calibration& calibration) {
  std::vector<Job> jobs;
  for (const SessionView& view : session.views) {
    for (const CalibratedTransform& t : calibration.transforms) {
      const auto model = calibration.cameras.find(t.parent);
      const auto image = view.images.find(t.parent);
      const auto cloud = view.clouds.find(t.child);
      if (model == calibration.cameras.end() || image == view.images.end() || cloud == view.clouds.end())
        continue;
      const auto lidar = calibration.lidars.find(t.child);
      const double sigma = lidar == calibration.lidars.end() ? 0 : lidar->second.range_sigma;
      jobs.push_back({view.id, t.parent, t.child, image->second, cloud->second, &model->second.camera,
                      t.T_parent_child, sigma});
    }
  }
  return jobs;
}

/// What the view's residuals are; nothing where the view is not in use.
struct Residuals {
  const std::vector<CornerError>* corners = nullptr;
  const std::vector<BoardPointError>* points = nullptr;
};

Residuals residuals_of(const Evidence* evidence, const Job& job) {
  if (evidence) {
    for (const ViewEvidence& view : evidence->views) {
      const auto corners = view.corners.find(job.camera);
      const auto points = view.points.find({job.camera, job.lidar});
      if (view.id == job.view && corners != view.corners.end() && points != view.points.end()) {
        return {&corners->second, &points->second};
      }
    }
  }
  return {};
}

/// Of each of so many pictures, px: the page stays under 15 MB. One of 640 px has some 170 kB with its
/// residuals and in base64, and 64 of them make 11 MB.
int picture_width(std::size_t pictures) {
  const double width = 640 * std::sqrt(64.0 / static_cast<double>(std::max<std::size_t>(pictures, 1)));
  return static_cast<int>(std::clamp(width, 160.0, 960.0));
}

std::string jpeg(const Image& image) {
  const Result<std::string> bytes = encode_jpeg(image, 68);
  return bytes ? *bytes : std::string();
}

Drawn draw(const Job& job, const Evidence* evidence, int width, bool first) {
  Drawn drawn;
  const Result<Image> image = read_png(job.image);
  const Result<Scan> scan = read_pcd(job.cloud);
  if (!image) drawn.problems = image.error().problems;
  if (!scan)
    drawn.problems.insert(drawn.problems.end(), scan.error().problems.begin(), scan.error().problems.end());
  if (!image || !scan) return drawn;
  Camera camera = *job.model;
  if (camera.width == 0) camera.width = image->width, camera.height = image->height;
  if (camera.width != image->width || camera.height != image->height) {
    drawn.problems.push_back(
        {job.image.string(), "the picture has another size than the calibrated camera", {}});
    return drawn;
  }
  const std::vector<SeenPoint> seen = seen_points(camera, *scan, job.T_camera_lidar);
  const Overlay overlay = draw_overlay(*image, seen, width);
  ReportPicture& picture = drawn.picture;
  picture = {job.view, job.camera, job.lidar, jpeg(overlay.image), {}, overlay.near, overlay.far, 0, 0};
  if (const Residuals residuals = residuals_of(evidence, job); residuals.corners) {
    picture.residual_scale = std::max(3 * job.range_sigma, 0.001);
    picture.magnified = 100;
    picture.residuals =
        jpeg(draw_residuals(*image, camera, job.T_camera_lidar, *residuals.corners, *residuals.points,
                            picture.residual_scale, picture.magnified, std::min(width, 560)));
  }
  if (first) {
    drawn.cloud = jpeg(draw_cloud(*image, seen, *scan, job.T_camera_lidar));
    drawn.ply = coloured_ply(*image, seen, *scan);
    drawn.overlay = draw_overlay(*image, seen, image->width).image;
  }
  return drawn;
}

}  // namespace

ReportPictures draw_pictures(const Session& session, const Calibration& calibration, const Evidence* evidence,
                             const std::function<void(int done, int total)>& progress) {
  const std::vector<Job> jobs = list_jobs(session, calibration);
  const int width = picture_width(jobs.size());
  std::vector<Drawn> drawn(jobs.size());
  std::atomic<std::size_t> next = 0, done = 0;
  const auto work = [&] {
    for (std::size_t i; (i = next++) < jobs.size(); ++done) drawn[i] = draw(jobs[i], evidence, width, i == 0);
  };
  {
    std::vector<std::jthread> threads;
    for (unsigned k = 0; k < std::max(1u, std::thread::hardware_concurrency()); ++k)
      threads.emplace_back(work);
    while (done < jobs.size()) {
      progress(static_cast<int>(done), static_cast<int>(jobs.size()));
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  }
  ReportPictures result;
  for (Drawn& d : drawn) {
    result.problems.insert(result.problems.end(), d.problems.begin(), d.problems.end());
    if (d.picture.overlay.empty()) continue;
    result.pictures.push_back(std::move(d.picture));
    if (!d.overlay.empty()) {
      result.cloud = std::move(d.cloud);
      result.ply = std::move(d.ply);
      result.overlay = std::move(d.overlay);
    }
  }
  return result;
}

}  // namespace ca2
