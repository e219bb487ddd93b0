#include "core/features/extract.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstdio>
#include <limits>
#include <mutex>
#include <thread>

#include "core/features/feature_cache.h"
#include "core/intrinsics/estimate_intrinsics.h"
#include "core/io/files.h"
#include "core/lidar/board_candidate.h"

namespace ca2 {
namespace {

/// Counts with every change of a search that can change its features: old cache files then no longer match.
constexpr int searches_version = 2;

std::string settings_of(const Board& board) {
  std::string text = std::to_string(searches_version);
  const Outline extent = board.extent();
  for (const double value : {static_cast<double>(board.columns), static_cast<double>(board.rows),
                             board.square, board.marker, board.spacing, extent.width, extent.height,
                             extent.center.x(), extent.center.y(), board.outline ? 1.0 : 0.0}) {
    char buffer[40];
    std::snprintf(buffer, sizeof buffer, " %.17g", value);
    text += buffer;
  }
  return std::string(board.type->name()) + ' ' + board.dictionary + text;
}

/// Returns whose rays pass within a quarter more than the board's half-diagonal of the patch's centre: what
/// edges and the choice of returns by ray are made from.
void gather_around(const Scan& scan, const std::vector<std::uint32_t>& taken, const Board& board,
                   LidarSight& sight) {
  const Outline extent = board.extent();
  const double distance = sight.center.norm();
  const double radius = 1.25 * 0.5 * std::hypot(extent.width, extent.height);
  const double cosine = std::cos(std::atan2(radius, distance));
  const Eigen::Vector3f axis = (sight.center / distance).cast<float>();
  std::vector<char> on_board(scan.size(), 0);
  for (const std::uint32_t i : taken) on_board[i] = 1;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const Eigen::Vector3f& p = scan.points[i];
    const BoardReturn here{
        p, scan.intensity.empty() ? std::numeric_limits<float>::quiet_NaN() : scan.intensity[i],
        scan.ring.empty() ? BoardReturn::no_ring : scan.ring[i]};
    if (on_board[i])
      sight.on_board.push_back(here);
    else if (p.dot(axis) > static_cast<float>(cosine) * p.norm())
      sight.around.push_back(here);  // false for NaN, too
  }
}

Result<std::vector<LidarSight>> search_cloud(const Board& board, const std::filesystem::path& file,
                                             const Pick* pick) {
  const Result<Scan> scan = read_pcd(file);
  if (!scan) return fail(scan.error());
  std::vector<BoardCandidate> candidates;
  if (pick) {
    Result<BoardCandidate> picked = fit_picked_patch(*scan, board, pick->row, pick->column, pick->radius);
    if (!picked) return fail(picked.error());
    candidates.push_back(std::move(*picked));
  } else {
    candidates = find_board_candidates(*scan, board);
  }
  std::vector<LidarSight> sights;
  for (const BoardCandidate& candidate : candidates) {
    LidarSight& sight = sights.emplace_back();
    sight.plane = candidate.plane;
    sight.center = candidate.T_lidar_board.t;
    if (board.outline && !pick) sight.outline_center = candidate.T_lidar_board.t;
    sight.rms = candidate.rms;
    sight.score = candidate.score;
    gather_around(*scan, candidate.returns, board, sight);
  }
  return sights;
}

Result<ImageFeatures> search_image(const Board& board, const std::filesystem::path& file) {
  const Result<Image> image = read_png(file);
  if (!image) return fail(image.error());
  return ImageFeatures{image->width, image->height, detect_board(board, *image)};
}

/// One file of one view, and what was found in it.
struct Task {
  std::size_t view = 0;
  std::string sensor;
  std::filesystem::path file;
  bool is_image = false;
  const Pick* pick = nullptr;
  ImageFeatures image;
  std::vector<LidarSight> cloud;
  std::optional<Error> error;
  bool cached = false;
};

void run(Task& task, const Board& board, const FeatureCache& cache, const std::string& view_name) {
  std::string name = view_name + '/' + task.sensor + ".features";
  if (task.pick) {  // a pick is a setting of this one file: it goes into the cached features' name
    name += '.' + std::to_string(task.pick->row) + '.' + std::to_string(task.pick->column) + '.' +
            std::to_string(task.pick->radius);
  }
  if (task.is_image) {
    if (auto kept = cache.load_image(name, task.file)) {
      task.image = std::move(*kept);
      task.cached = true;
      return;
    }
    Result<ImageFeatures> found = search_image(board, task.file);
    if (!found) {
      task.error = found.error();
      return;
    }
    task.image = std::move(*found);
    cache.store_image(name, task.file, task.image);
    return;
  }
  if (auto kept = cache.load_cloud(name, task.file)) {
    task.cloud = std::move(*kept);
    task.cached = true;
    return;
  }
  Result<std::vector<LidarSight>> found = search_cloud(board, task.file, task.pick);
  if (!found) {
    task.error = found.error();
    return;
  }
  task.cloud = std::move(*found);
  cache.store_cloud(name, task.file, task.cloud);
}

/// Runs body(0) .. body(count - 1) on several threads; progress is called from this one.
void in_parallel(std::size_t count, int threads, const std::function<void(std::size_t)>& body,
                 const std::function<void(int, int)>& progress) {
  std::atomic<std::size_t> next{0};
  std::size_t done = 0;
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<std::jthread> workers;
  for (int t = 0; t < threads; ++t) {
    workers.emplace_back([&] {
      for (std::size_t i = next++; i < count; i = next++) {
        body(i);
        const std::lock_guard lock(mutex);
        ++done;
        changed.notify_one();
      }
    });
  }
  std::unique_lock lock(mutex);
  for (std::size_t shown = 0; shown < count;) {
    changed.wait(lock, [&] { return done > shown; });
    shown = done;
    lock.unlock();
    if (progress) progress(static_cast<int>(shown), static_cast<int>(count));
    lock.lock();
  }
}

Result<std::vector<Task>> list_tasks(const Session& session, const std::vector<int>& wanted) {
  std::vector<Task> tasks;
  for (const int id : wanted) {
    const auto has_id = [&](const SessionView& view) { return view.id == id; };
    if (std::none_of(session.views.begin(), session.views.end(), has_id)) {
      return fail(ErrorCode::usage, session.directory.string(), "there is no view " + std::to_string(id),
                  "`ca2 check` lists the session's views");
    }
  }
  for (std::size_t v = 0; v < session.views.size(); ++v) {
    const SessionView& view = session.views[v];
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), view.id) == wanted.end()) continue;
    const auto add = [&](const std::string& sensor, const std::filesystem::path& file, bool is_image,
                         const Pick* pick) {
      Task& task = tasks.emplace_back();
      task.view = v;
      task.sensor = sensor;
      task.file = file;
      task.is_image = is_image;
      task.pick = pick;
    };
    for (const auto& [camera, file] : view.images) add(camera, file, true, nullptr);
    for (const auto& [lidar, file] : view.clouds) {
      const auto pick = view.picks.find(lidar);
      add(lidar, file, false, pick == view.picks.end() ? nullptr : &pick->second);
    }
  }
  if (tasks.empty()) {
    return fail(ErrorCode::data, session.directory.string(), "the session has no views",
                "a view is a directory views/000001 with one PNG per camera and one PCD per LiDAR");
  }
  return tasks;
}

std::string size_text(int width, int height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

/// Brings the tasks' findings together, view by view; intrinsics that are not given are estimated on the way.
class Assembly {
 public:
  Assembly(const Session& session, std::vector<Task> tasks) : session_(session), tasks_(std::move(tasks)) {
    result_.rig = session.rig;
  }

  Result<Extraction> make() {
    for (Task& task : tasks_) {
      if (task.error) take_problem(task, task.error->problems);
      ++(task.cached ? result_.cached : result_.searched);
    }
    settle_picture_sizes();
    if (auto error = estimate_missing_intrinsics()) return fail(std::move(*error));
    std::size_t broken = 0;
    for (const Task& task : tasks_) broken += task.error ? 1 : 0;
    if (broken == tasks_.size()) return fail(ErrorCode::data, std::move(result_.problems));
    for (std::size_t v = 0; v < session_.views.size(); ++v) {
      const auto of_view = [&](const Task& task) { return task.view == v; };
      if (std::any_of(tasks_.begin(), tasks_.end(), of_view)) result_.views.push_back(sights_of(v));
    }
    return std::move(result_);
  }

 private:
  void take_problem(Task& task, const std::vector<Problem>& problems) {
    if (!task.error) task.error = Error(ErrorCode::data, problems);
    result_.problems.insert(result_.problems.end(), problems.begin(), problems.end());
  }

  /// Every picture must have the size that the rig gives, or that the first picture has.
  void settle_picture_sizes() {
    for (Task& task : tasks_) {
      if (!task.is_image || task.error) continue;
      RigCamera& camera = result_.rig.cameras.at(task.sensor);
      if (camera.width == 0 && camera.intrinsics) {
        camera.width = camera.intrinsics->width;
        camera.height = camera.intrinsics->height;
      }
      if (camera.width == 0) {
        camera.width = task.image.width;
        camera.height = task.image.height;
      }
      if (camera.intrinsics && camera.intrinsics->width == 0) {
        camera.intrinsics->width = camera.width;
        camera.intrinsics->height = camera.height;
      }
      if (task.image.width == camera.width && task.image.height == camera.height) continue;
      take_problem(task,
                   {{task.file.string(),
                     "the picture is " + size_text(task.image.width, task.image.height) + ", the camera '" +
                         task.sensor + "' has " + size_text(camera.width, camera.height),
                     "intrinsics hold for one size only: give pictures as the camera made them"}});
    }
  }

  std::optional<Error> estimate_missing_intrinsics() {
    std::vector<Problem> refusals;
    for (auto& [name, camera] : result_.rig.cameras) {
      if (camera.intrinsics) continue;
      std::vector<std::vector<Corner>> views;
      for (const Task& task : tasks_) {
        if (task.is_image && task.sensor == name && !task.error && !task.image.corners.empty()) {
          views.push_back(task.image.corners);
        }
      }
      const Result<IntrinsicsEstimate> estimate =
          estimate_intrinsics(result_.rig.board, camera.width, camera.height, camera.model, views);
      if (!estimate) {
        for (Problem problem : estimate.error().problems) {
          problem.where = name + (problem.where.empty() ? "" : ": " + problem.where);
          refusals.push_back(std::move(problem));
        }
        continue;
      }
      camera.intrinsics = estimate->camera;
      result_.estimated[name] = estimate->covariance.diagonal().cwiseSqrt();
    }
    if (refusals.empty()) return std::nullopt;
    return Error(ErrorCode::refused, std::move(refusals));
  }

  ViewSights sights_of(std::size_t v) {
    ViewSights sights;
    sights.id = session_.views[v].id;
    const auto find = [&](const std::string& sensor) -> Task* {
      for (Task& task : tasks_) {
        if (task.view == v && task.sensor == sensor) return &task;
      }
      return nullptr;
    };
    for (const auto& [name, camera] : result_.rig.cameras) {
      std::optional<CameraSight>& sight = sights.cameras.emplace_back();
      Task* task = find(name);
      if (!task || task->error) {
        if (task) sights.problem = task->error->problems.front().what;
        continue;
      }
      if (task->image.corners.empty()) continue;
      Result<BoardPose> pose =
          estimate_board_pose(result_.rig.board, *camera.intrinsics, task->image.corners);
      if (pose)
        sight = CameraSight{std::move(task->image.corners), *pose};
      else
        sights.problem = pose.error().problems.front().what;
    }
    for (const auto& [name, lidar] : result_.rig.lidars) {
      std::vector<LidarSight>& hypotheses = sights.lidars.emplace_back();
      Task* task = find(name);
      if (task && task->error)
        sights.problem = task->error->problems.front().what;
      else if (task)
        hypotheses = std::move(task->cloud);
    }
    return sights;
  }

  const Session& session_;
  std::vector<Task> tasks_;
  Extraction result_;
};

}  // namespace

Result<Extraction> extract_features(const Session& session, const ExtractOptions& options) {
  Result<std::vector<Task>> tasks = list_tasks(session, options.views);
  if (!tasks) return fail(tasks.error());
  const FeatureCache cache(options.cache ? session.directory / "cache" : std::filesystem::path(),
                           settings_of(session.rig.board));
  const int cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  const auto body = [&](std::size_t i) {
    run((*tasks)[i], session.rig.board, cache, session.views[(*tasks)[i].view].directory.filename().string());
  };
  in_parallel(tasks->size(), options.threads > 0 ? options.threads : cores, body, options.progress);
  return Assembly(session, std::move(*tasks)).make();
}

}  // namespace ca2
