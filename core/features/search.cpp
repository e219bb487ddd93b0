#include "core/features/search.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstdio>
#include <mutex>
#include <thread>

#include "core/features/lidar_sights.h"
#include "core/io/files.h"
#include "core/types/counted.h"

namespace ca2 {
namespace {

/// Counts with every change of a search that can change its features: old cache files then no longer match.
constexpr int searches_version = 5;

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

FeatureCache cache_of(const Session& session) {
  return {session.directory / "cache", settings_of(session.rig.board)};
}

/// A name in the cache.
std::string cached_name(const Session& session, const SensorFile& file) {
  std::string name = session.views[file.view].directory.filename().string() + '/' + file.sensor + ".features";
  if (file.pick) {  // a pick is a setting of this one file: it goes into the cached features' name
    name += '.' + std::to_string(file.pick->row) + '.' + std::to_string(file.pick->column) + '.' +
            std::to_string(file.pick->radius);
  }
  return name;
}

/// From the cache, where it knows.
bool recall(SensorFile& file, const FeatureCache& cache, const std::string& name) {
  if (file.is_image) {
    auto kept = cache.load_image(name, file.path);
    if (kept) file.image = std::move(*kept);
    file.cached = kept.has_value();
  } else {
    auto kept = cache.load_cloud(name, file.path);
    if (kept) file.cloud = std::move(*kept);
    file.cached = kept.has_value();
  }
  return file.cached;
}

void keep(const SensorFile& file, const FeatureCache& cache, const std::string& name) {
  if (file.error) return;
  if (file.is_image)
    cache.store_image(name, file.path, file.content, file.image);
  else
    cache.store_cloud(name, file.path, file.content, file.cloud);
}

void read_and_search(SensorFile& file, const Board& board) {
  if (file.is_image) {
    const Result<Image> image = read_png(file.path);
    image ? search_image(file, board, *image) : void(file.error = image.error());
  } else {
    const Result<Scan> scan = read_pcd(file.path);
    scan ? search_cloud(file, board, *scan) : void(file.error = scan.error());
  }
}

void run(const Session& session, SensorFile& file, const FeatureCache& cache) {
  const std::string name = cached_name(session, file);
  if (recall(file, cache, name)) return;
  read_and_search(file, session.rig.board);
  keep(file, cache, name);
}

/// Why there can be nothing in the cloud; nothing where it has returns.
std::optional<Error> without_returns(const Scan& scan, const std::filesystem::path& file) {
  if (scan.returns() > 0) return std::nullopt;
  return Error(ErrorCode::data, file.string(),
               scan.empty() ? "the cloud has no points"
                            : "none of the cloud's " + counted(scan.size(), "point") + " is a return");
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

/// "the session has 8 views, 1 to 8": for whoever asked for another one.
std::string view_range(const Session& session) {
  if (session.views.empty()) return "the session has no views";
  const std::string count = "the session has " + counted(session.views.size(), "view");
  if (session.views.size() == 1) return count + ", " + std::to_string(session.views.front().id);
  return count + ", from " + std::to_string(session.views.front().id) + " to " +
         std::to_string(session.views.back().id);
}

}  // namespace

Result<Scan> read_cloud(const std::filesystem::path& file) {
  Result<Scan> scan = read_pcd(file);
  if (!scan) return scan;
  if (auto why = without_returns(*scan, file)) return fail(std::move(*why));
  return scan;
}

void search_image(SensorFile& file, const Board& board, const Image& image) {
  file.image = {image.width, image.height, detect_board(board, image)};
}

void search_cloud(SensorFile& file, const Board& board, const Scan& scan) {
  file.error = without_returns(scan, file.path);
  if (file.error) return;
  if (!file.pick) {
    file.cloud = find_sights(scan, board);
    return;
  }
  Result<LidarSight> picked = picked_sight(scan, board, *file.pick);
  if (picked)
    file.cloud = {std::move(*picked)};
  else
    file.error = picked.error();
}

void keep_found(const Session& session, const std::vector<SensorFile>& files) {
  const FeatureCache cache = cache_of(session);
  for (const SensorFile& file : files) keep(file, cache, cached_name(session, file));
}

Result<std::vector<SensorFile>> list_files(const Session& session, const std::vector<int>& wanted) {
  std::vector<SensorFile> files;
  for (const int id : wanted) {
    const auto has_id = [&](const SessionView& view) { return view.id == id; };
    if (std::none_of(session.views.begin(), session.views.end(), has_id)) {
      return fail(ErrorCode::usage, session.directory.string(), "there is no view " + std::to_string(id),
                  view_range(session));
    }
  }
  for (std::size_t v = 0; v < session.views.size(); ++v) {
    const SessionView& view = session.views[v];
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), view.id) == wanted.end()) continue;
    const auto add = [&](const std::string& sensor, const std::filesystem::path& path, bool is_image,
                         const Pick* pick) {
      SensorFile& file = files.emplace_back();
      file.view = v;
      file.sensor = sensor;
      file.path = path;
      file.is_image = is_image;
      file.pick = pick;
    };
    for (const auto& [camera, file] : view.images) add(camera, file, true, nullptr);
    for (const auto& [lidar, file] : view.clouds) {
      const auto pick = view.picks.find(lidar);
      add(lidar, file, false, pick == view.picks.end() ? nullptr : &pick->second);
    }
  }
  if (files.empty()) {
    return fail(ErrorCode::data, session.directory.string(), "the session has no views",
                "a view is a directory views/000001 with one PNG per camera and one PCD per LiDAR");
  }
  return files;
}

void add_contents(const Session& session, std::vector<SensorFile>& files, bool cached) {
  const FeatureCache cache = cached ? cache_of(session) : FeatureCache({}, {});
  for (SensorFile& file : files) {
    file.content = cache.content(cached_name(session, file), file.path);
    if (!file.content) file.content = content_of(file.path);
  }
}

void search(const Session& session, std::vector<SensorFile>& files, const ExtractOptions& options) {
  const FeatureCache cache = options.cache ? cache_of(session) : FeatureCache({}, {});
  const int cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  const auto body = [&](std::size_t i) { run(session, files[i], cache); };
  in_parallel(files.size(), options.threads > 0 ? options.threads : cores, body, options.progress);
}

}  // namespace ca2
