#include "tests/core/capture/script.h"

#include <cmath>

namespace ca2::test {

Pose board_at(double x, double y, double z, double tilt, double turn) {
  return {so3_exp(tilt * Eigen::Vector3d(std::cos(turn), std::sin(turn), 0)), {x, y, z}};
}

Script::Script() {
  rig.board.type = find_board_type("checkerboard");
  rig.board.columns = 8;
  rig.board.rows = 6;
  rig.board.square = 0.04;
  rig.board.outline = Outline{0.42, 0.297, {0, 0}};
  Camera camera;
  camera.model = find_camera_model("pinhole_radtan");
  camera.parameters = CameraParameters(8);
  camera.parameters << 800, 800, 319.5, 239.5, 0, 0, 0, 0;
  camera.width = 640;
  camera.height = 480;
  rig.cameras["left"].intrinsics = camera;
  rig.cameras["left"].width = 640;
  rig.cameras["left"].height = 480;
  rig.lidars["top"] = {};
  T_camera_lidar.R << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  T_camera_lidar.t = {0.1, -0.1, 0};
  Image picture{640, 480, 1, 8, std::vector<std::uint8_t>(640 * 480, 100)};
  picture_ = std::make_shared<const Image>(std::move(picture));
  store = [this](const StoreView& view) {
    ViewSights sights;
    sights.id = view.id;
    const double time = stored.back().time;
    CameraObservation seen = see(time);
    sights.cameras.emplace_back();
    if (view.images.contains("left") && !seen.corners.empty()) {
      const auto pose = estimate_board_pose(rig.board, *rig.cameras["left"].intrinsics, seen.corners);
      if (pose) sights.cameras.back() = CameraSight{seen.corners, *pose};
    }
    sights.lidars.push_back(scan(time).sights);
    return Result<ViewSights>(sights);
  };
}

CameraObservation Script::see(double time) {
  CameraObservation observation;
  observation.time = std::llround(time * 1e9);
  observation.image = picture_;
  const std::optional<Pose> pose = T_camera_board(time);
  if (!pose) return observation;
  const Camera& camera = *rig.cameras["left"].intrinsics;
  std::normal_distribution<double> noise(0, corner_sigma);
  const auto places = rig.board.type->corners(rig.board);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto pixel = camera.project(*pose * Eigen::Vector3d(places[i].x(), places[i].y(), 0));
    if (!pixel || !camera.contains(*pixel, 5)) return observation;  // a checkerboard is found whole or not
    observation.corners.push_back({static_cast<int>(i), *pixel + Eigen::Vector2d(noise(rng_), noise(rng_)),
                                   Eigen::Matrix2d::Identity() * corner_sigma * corner_sigma});
  }
  if (observation.corners.size() != places.size()) observation.corners.clear();
  return observation;
}

LidarSight Script::sight_of(const Pose& T_lidar_board) {
  LidarSight sight;
  std::normal_distribution<double> noise(0, range_sigma);
  std::vector<Eigen::Vector3d> points;
  for (double x = -0.2; x < 0.21; x += 0.02) {
    std::uint16_t ring = 0;
    for (double y = -0.14; y < 0.15; y += 0.035) {
      const Eigen::Vector3d p = T_lidar_board * Eigen::Vector3d(x, y, 0);
      points.push_back(p + noise(rng_) * p.normalized());
      sight.on_board.push_back({points.back().cast<float>(), ring++});
    }
  }
  sight.plane = fit_plane(points);
  sight.center = T_lidar_board.t;
  sight.rms = range_sigma;
  sight.score = 0.8;
  return sight;
}

LidarObservation Script::scan(double time) {
  LidarObservation observation;
  observation.time = std::llround((time + lidar_offset) * 1e9);
  Scan scan;
  scan.points.emplace_back(1, 0, 0);
  observation.scan = std::make_shared<const Scan>(std::move(scan));
  if (const std::optional<Pose> pose = T_camera_board(time)) {
    observation.sights.push_back(sight_of(T_camera_lidar.inverse() * *pose));
    observation.novelty.push_back(1);
  }
  for (const Pose& other : others(time)) {
    observation.sights.push_back(sight_of(other));
    observation.novelty.push_back(0);
  }
  return observation;
}

void Script::handle(CapturePipeline& pipeline, double time, CaptureActions actions) {
  const std::int64_t now = std::llround(time * 1e9);
  for (CaptureAction& action : actions) {
    if (auto* event = std::get_if<CaptureEvent>(&action)) events.push_back(*event);
    if (auto* drop = std::get_if<DropView>(&action)) dropped.push_back(drop->id);
    if (auto* solve = std::get_if<SolveViews>(&action)) solves.push_back(*solve);
    if (auto* view = std::get_if<StoreView>(&action)) {
      stored.push_back({time, std::move(*view)});
      handle(pipeline, time, pipeline.stored(now, stored.back().view.id, store(stored.back().view)));
    }
  }
}

void Script::run(CapturePipeline& pipeline, double from, double to) {
  next_picture_ = static_cast<int>(std::ceil(from * camera_rate));
  next_scan_ = static_cast<int>(std::ceil(from * lidar_rate));
  for (;;) {
    // A picture is there at once; a scan half a revolution after its middle.
    const double picture = next_picture_ / camera_rate, scan_end = (next_scan_ + 0.5) / lidar_rate;
    if (std::min(picture, scan_end) > to) return;
    if (picture <= scan_end) {
      ++next_picture_;
      if (!camera_lost(picture)) handle(pipeline, picture, pipeline.add(see(picture)));
    } else {
      const double middle = next_scan_++ / lidar_rate;
      if (!lidar_lost(middle)) handle(pipeline, scan_end, pipeline.add(scan(middle)));
    }
    handle(pipeline, std::min(picture, scan_end),
           pipeline.tick(std::llround(1e9 * std::min(picture, scan_end))));
  }
}

Poses& Poses::hold(const Pose& pose, double duration) {
  const double from = holds_.empty() ? 0 : end_ + 0.5;
  end_ = from + duration;
  holds_.push_back({from, end_, pose});
  return *this;
}

std::optional<Pose> Poses::at(double time) const {
  for (std::size_t i = 0; i < holds_.size(); ++i) {
    if (time <= holds_[i].to && time >= holds_[i].from) return holds_[i].pose;
    if (i + 1 < holds_.size() && time > holds_[i].to && time < holds_[i + 1].from) {
      const double s = (time - holds_[i].to) / (holds_[i + 1].from - holds_[i].to);
      return holds_[i].pose.perturbed(s * holds_[i].pose.difference(holds_[i + 1].pose));
    }
  }
  return std::nullopt;
}

}  // namespace ca2::test
