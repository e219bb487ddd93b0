#include "tools/ca2/import_pairs.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>

#include "core/io/cloud_files.h"
#include "core/io/read_picture.h"
#include "tools/ca2/nearest_pairs.h"

namespace ca2 {
namespace {

namespace fs = std::filesystem;

struct Numbered {
  std::int64_t key = 0;  ///< the number, or ns where it is a time
  bool time = false;
  fs::path path;
};

/// ns in what so many digits count in our century: ms have 13, us 16, ns 19; 0 where they are a mere number.
std::int64_t time_unit(std::ptrdiff_t digits) {
  return digits < 13 ? 0 : digits <= 14 ? 1'000'000 : digits <= 17 ? 1000 : 1;
}

/// The last run of digits of the name; nothing where there is none, or it is too long for a number.
std::optional<Numbered> numbered(const fs::path& file) {
  const std::string stem = file.stem().string();
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  const auto end = std::find_if(stem.rbegin(), stem.rend(), digit).base();
  const auto begin = std::find_if_not(std::make_reverse_iterator(end), stem.rend(), digit).base();
  Numbered found{0, false, file};
  const char* first = stem.data() + (begin - stem.begin());
  if (std::from_chars(first, first + (end - begin), found.key).ec != std::errc()) return std::nullopt;
  const std::int64_t unit = time_unit(end - begin);
  // A date (20240115123456) is too large to be a time: equal ones go together.
  found.time = unit > 0 && found.key <= std::numeric_limits<std::int64_t>::max() / unit;
  if (found.time) found.key *= unit;
  return found;
}

Result<std::vector<fs::path>> files_under(const fs::path& folder, bool pictures) {
  std::vector<fs::path> files;
  std::error_code error;
  fs::recursive_directory_iterator at(folder, error);
  for (; !error && at != fs::recursive_directory_iterator(); at.increment(error)) {
    const fs::path& path = at->path();
    if (path.filename().string().front() == '.' || !at->is_regular_file()) continue;
    if (pictures ? is_picture_name(path) : is_cloud_name(path)) files.push_back(path);
  }
  if (error) return fail(ErrorCode::io, folder.string(), "cannot be listed: " + error.message());
  std::sort(files.begin(), files.end());
  return files;
}

struct SensorFiles {
  std::string sensor;
  std::vector<Numbered> files;  ///< by rising key
};

}  // namespace

Result<ImportPlan> plan_import(const fs::path& folder, const Rig& rig, double tolerance) {
  const bool anywhere = rig.cameras.size() == 1 && rig.lidars.size() <= 1;
  std::vector<SensorFiles> sensors;
  std::vector<Problem> problems;
  std::size_t timed = 0, all = 0;
  const auto collect = [&](const std::string& sensor, bool is_camera) -> Result<void> {
    std::error_code error;
    const fs::path own = folder / sensor;
    const bool has_own = fs::is_directory(own, error);
    if (!has_own && !anywhere) {
      problems.push_back({own.string(), "there is no such folder",
                          "with several cameras or LiDARs each has its files in a folder of its name"});
      return {};
    }
    const Result<std::vector<fs::path>> files = files_under(has_own ? own : folder, is_camera);
    if (!files) return fail(files.error());
    SensorFiles found{sensor, {}};
    for (const fs::path& path : *files) {
      std::optional<Numbered> one = numbered(path);
      // Tables of numbers beside the clouds (imu.csv) are no clouds of a view.
      if (!one) continue;
      timed += one->time;
      ++all;
      found.files.push_back(std::move(*one));
    }
    std::stable_sort(found.files.begin(), found.files.end(),
                     [](const Numbered& a, const Numbered& b) { return a.key < b.key; });
    if (found.files.empty()) {
      problems.push_back({(has_own ? own : folder).string(),
                          std::string("has no ") +
                              (is_camera ? "pictures (PNG, JPEG)" : "clouds (PCD, PLY, CSV, NPY)") + " of '" +
                              sensor + "' with a number in their names",
                          "give the files of a view the same number"});
    }
    sensors.push_back(std::move(found));
    return {};
  };
  for (const auto& [name, camera] : rig.cameras) {
    if (const auto done = collect(name, true); !done) return fail(done.error());
  }
  for (const auto& [name, lidar] : rig.lidars) {
    if (const auto done = collect(name, false); !done) return fail(done.error());
  }
  if (!problems.empty()) return fail(ErrorCode::data, problems);

  ImportPlan plan;
  plan.timed = timed == all;
  const auto reach = plan.timed ? static_cast<std::int64_t>(std::llround(tolerance * 1e9)) : 0;
  std::vector<SensorKeys> keys;
  for (const SensorFiles& sensor : sensors) {
    keys.push_back({sensor.sensor, {}});
    for (const Numbered& file : sensor.files) keys.back().second.push_back(file.key);
  }
  const Pairing pairing = pair_nearest(keys, reach);
  plan.single = pairing.single;
  for (const auto& group : pairing.groups) {
    ImportGroup files;
    for (const SensorFiles& sensor : sensors) {
      const auto at = group.find(sensor.sensor);
      if (at != group.end()) files[sensor.sensor] = sensor.files[at->second].path;
    }
    plan.groups.push_back(std::move(files));
  }
  return plan;
}

}  // namespace ca2
