#include "core/features/extract.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "core/features/other_counts.h"
#include "core/features/search.h"
#include "core/intrinsics/estimate_intrinsics.h"

namespace ca2 {
namespace {

std::string size_text(int width, int height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

/// Brings the findings together, view by view; intrinsics that are not given are estimated on the way.
class Assembly {
 public:
  Assembly(const Session& session, std::vector<SensorFile> files)
      : session_(session), files_(std::move(files)) {
    result_.rig = session.rig;
  }

  Result<Extraction> make() {
    for (const SensorFile& file : files_) {
      if (file.error) add_problems(file.error->problems);
      ++(file.cached ? result_.cached : result_.searched);
    }
    settle_picture_sizes();
    if (auto error = find_blind_sensors()) return fail(std::move(*error));
    if (auto error = estimate_missing_intrinsics()) return fail(std::move(*error));
    for (std::size_t v = 0; v < session_.views.size(); ++v) {
      const auto of_view = [&](const SensorFile& file) { return file.view == v; };
      if (std::any_of(files_.begin(), files_.end(), of_view)) result_.views.push_back(sights_of(v));
    }
    return std::move(result_);
  }

  /// One view, whatever the others have.
  Result<ViewSights> make_view(std::size_t v) {
    settle_picture_sizes();
    for (const SensorFile& file : files_) {
      if (file.error) return fail(*file.error);
    }
    return sights_of(v);
  }

 private:
  void add_problems(const std::vector<Problem>& problems) {
    result_.problems.insert(result_.problems.end(), problems.begin(), problems.end());
  }

  /// What refuses the whole, after what is wrong with single files: often its cause.
  Error refusal(ErrorCode code, const std::vector<Problem>& problems) {
    add_problems(problems);
    return Error(code, std::move(result_.problems));
  }

  /// The size that most pictures of the camera have; the earlier view's where two are as frequent.
  std::pair<int, int> usual_size(const std::string& camera) const {
    std::vector<std::pair<int, int>> sizes;
    for (const SensorFile& file : files_) {
      if (file.is_image && !file.error && file.sensor == camera)
        sizes.emplace_back(file.image.width, file.image.height);
    }
    const auto times = [&](const std::pair<int, int>& size) {
      return std::count(sizes.begin(), sizes.end(), size);
    };
    const auto usual = std::max_element(sizes.begin(), sizes.end(),
                                        [&](const auto& a, const auto& b) { return times(a) < times(b); });
    return usual == sizes.end() ? std::pair(0, 0) : *usual;
  }

  /// Every picture must have the size that the rig gives, or else the usual one.
  void settle_picture_sizes() {
    for (auto& [name, camera] : result_.rig.cameras) {
      if (camera.width == 0 && camera.intrinsics) {
        camera.width = camera.intrinsics->width;
        camera.height = camera.intrinsics->height;
      }
      if (camera.width == 0) std::tie(camera.width, camera.height) = usual_size(name);
      if (camera.intrinsics && camera.intrinsics->width == 0) {
        camera.intrinsics->width = camera.width;
        camera.intrinsics->height = camera.height;
      }
    }
    for (SensorFile& file : files_) {
      if (!file.is_image || file.error) continue;
      const RigCamera& camera = result_.rig.cameras.at(file.sensor);
      if (file.image.width == camera.width && file.image.height == camera.height) continue;
      file.error =
          Error(ErrorCode::data, file.path.string(),
                "the picture is " + size_text(file.image.width, file.image.height) + ", the camera '" +
                    file.sensor + "' has " + size_text(camera.width, camera.height),
                "intrinsics hold for one size only: give pictures as the camera made them");
      add_problems(file.error->problems);
    }
  }

  std::string hint_for_camera(const std::string& name) const {
    const Board& board = result_.rig.board;
    const std::optional<OtherCounts> other = find_other_counts(board, files_, name);
    if (!other) return "is it the board of the rig (type, columns, rows), and whole in the picture?";
    const auto text = [](int columns, int rows) {
      return std::to_string(columns) + " x " + std::to_string(rows);
    };
    return "one of " + text(other->columns, other->rows) + " inner corners is in " + other->picture.string() +
           ", the rig says " + text(board.columns, board.rows) +
           ": columns and rows count inner corners, not squares";
  }

  /// A sensor that never saw the board cannot be calibrated, and its name says more than what the solver
  /// could.
  std::optional<Error> find_blind_sensors() {
    std::vector<Problem> blind;
    ErrorCode code = ErrorCode::refused;
    const auto look_at = [&](const std::string& name, bool is_camera) {
      std::size_t all = 0;
      std::size_t broken = 0;
      for (const SensorFile& file : files_) {
        if (file.sensor != name) continue;
        if (file.sees_board()) return;
        ++all;
        broken += file.error ? 1 : 0;
      }
      const std::string files = is_camera ? "pictures" : "clouds";
      if (all == 0) {
        blind.push_back({name, "there are no " + files + " of this sensor in the views",
                         "record some, or take the sensor out of the rig"});
      } else if (broken == all) {
        code = ErrorCode::data;
        blind.push_back({name, "none of its " + std::to_string(all) + " " + files + " can be used", {}});
      } else {
        blind.push_back({name, "the board was found in none of its " + std::to_string(all) + " " + files,
                         is_camera ? hint_for_camera(name)
                                   : "does it have the size that the rig says, and stand free of walls?"});
      }
    };
    for (const auto& [name, camera] : result_.rig.cameras) look_at(name, true);
    for (const auto& [name, lidar] : result_.rig.lidars) look_at(name, false);
    if (blind.empty()) return std::nullopt;
    return refusal(code, blind);
  }

  std::optional<Error> estimate_missing_intrinsics() {
    std::vector<Problem> refusals;
    for (auto& [name, camera] : result_.rig.cameras) {
      if (camera.intrinsics) continue;
      std::vector<std::vector<Corner>> views;
      for (const SensorFile& file : files_) {
        if (file.sensor == name && file.sees_board()) views.push_back(file.image.corners);
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
    return refusal(ErrorCode::refused, refusals);
  }

  /// The sensor's file of a view; where there is none, or none that can be used, `problem` says so.
  SensorFile* usable_file(std::size_t v, const std::string& sensor, bool is_camera, std::string& problem) {
    for (SensorFile& file : files_) {
      if (file.view != v || file.sensor != sensor) continue;
      if (!file.error) return &file;
      problem = file.path.filename().string() + ": " + file.error->problems.front().what;
      return nullptr;
    }
    problem = std::string("there is no ") + (is_camera ? "picture" : "cloud") + " of " + sensor;
    return nullptr;
  }

  ViewSights sights_of(std::size_t v) {
    ViewSights sights;
    sights.id = session_.views[v].id;
    for (const auto& [name, camera] : result_.rig.cameras) {
      std::optional<CameraSight>& sight = sights.cameras.emplace_back();
      SensorFile* file = usable_file(v, name, true, sights.problem);
      if (!file || file->image.corners.empty()) continue;
      if (!camera.intrinsics) {
        sight = CameraSight{std::move(file->image.corners), {}};
        continue;
      }
      Result<BoardPose> pose =
          estimate_board_pose(result_.rig.board, *camera.intrinsics, file->image.corners);
      if (pose)
        sight = CameraSight{std::move(file->image.corners), *pose};
      else
        sights.problem = pose.error().problems.front().what;
    }
    for (const auto& [name, lidar] : result_.rig.lidars) {
      std::vector<LidarSight>& hypotheses = sights.lidars.emplace_back();
      if (SensorFile* file = usable_file(v, name, false, sights.problem)) hypotheses = std::move(file->cloud);
    }
    return sights;
  }

  const Session& session_;
  std::vector<SensorFile> files_;
  Extraction result_;
};

}  // namespace

Result<Extraction> extract_features(const Session& session, const ExtractOptions& options) {
  if (session.rig.cameras.empty() || session.rig.lidars.empty()) {
    return fail(ErrorCode::config, (session.directory / "session.yaml").string(),
                session.rig.cameras.empty() ? "the rig has no camera" : "the rig has no lidar",
                "a calibration needs at least one camera and one lidar");
  }
  Result<std::vector<SensorFile>> files = list_files(session, options.views);
  if (!files) return fail(files.error());
  search(session, *files, options);
  return Assembly(session, std::move(*files)).make();
}

Result<ViewSights> extract_view(const Session& session, int id) {
  Result<std::vector<SensorFile>> files = list_files(session, {id});
  if (!files) return fail(files.error());
  search(session, *files, {});
  return view_sights(session, std::move(*files));
}

Result<ViewSights> view_sights(const Session& session, std::vector<SensorFile> files) {
  const std::size_t view = files.front().view;
  return Assembly(session, std::move(files)).make_view(view);
}

}  // namespace ca2
