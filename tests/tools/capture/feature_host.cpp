#include "tests/tools/capture/feature_host.h"

#include <algorithm>
#include <cmath>

#include "core/capture/solve_views.h"
#include "core/io/yaml_reader.h"
#include "tools/sim/feature_sights.h"
#include "tools/sim/placement.h"
#include "tools/sim/range_model.h"
#include "tools/sim/rim_simulator.h"

namespace ca2::test {
namespace {

constexpr double start = 1000;  // s: the pipeline's time 0 is nobody's

std::int64_t stamp(double time) {
  return std::llround(1e9 * (start + time));
}

/// The first and last of the stamps of view.yaml's first camera, and their number.
void read_stamps(const StoreView& view, StoredView& out) {
  const auto root = parse_yaml(view.details, "view.yaml");
  const YamlNode* stamps = root->find("stamps");
  const YamlNode* list = stamps->find(view.images.begin()->first);
  YamlReader reader("view.yaml");
  const auto seconds = [&](const YamlNode& node) {
    return FeatureHost::seconds(*reader.integer(&node, 0, std::numeric_limits<long long>::max()));
  };
  out.first = seconds(list->items.front());
  out.last = seconds(list->items.back());
  out.pictures = list->items.size();
}

}  // namespace

FeatureHost::FeatureHost(const Scenario& scenario, const PersonMotion& motion, FeatureHostOptions options)
    : scenario_(scenario),
      motion_(motion),
      options_(std::move(options)),
      pipeline_(rig_of(scenario), {}, {}),
      picture_(std::make_shared<const Image>(Image{8, 8, 1, 8, std::vector<std::uint8_t>(64, 100)})) {
  for (const auto& [name, camera] : scenario.cameras) cameras_.push_back(name);
  for (const auto& [name, lidar] : scenario.lidars) lidars_.push_back(name);
  Scan scan;
  scan.points.emplace_back(1, 0, 0);
  scan_ = std::make_shared<const Scan>(std::move(scan));
}

double FeatureHost::seconds(std::int64_t time) {
  return 1e-9 * static_cast<double>(time) - start;
}

const TrueHold* FeatureHost::hold_at(double time) const {
  const auto& holds = motion_.holds();
  const auto at = std::find_if(holds.begin(), holds.end(),
                               [&](const TrueHold& hold) { return hold.from <= time && time <= hold.to; });
  return at == holds.end() ? nullptr : &*at;
}

CameraObservation FeatureHost::see(int index, double time) {
  CameraObservation observation;
  observation.camera = index;
  observation.time = stamp(time + options_.clock_offset);
  observation.image = picture_;
  const SimulatedCamera& camera = scenario_.cameras.at(cameras_[static_cast<std::size_t>(index)]);
  const Pose T_camera_board = camera.T_rig_camera.inverse() * motion_.at(time);
  // Its back shows no print.
  if (T_camera_board.R.col(2).dot(T_camera_board.t) <= 0.1 * T_camera_board.t.norm()) return observation;
  const double sigma = camera.noise.corner_sigma;
  std::normal_distribution<double> noise(0, sigma);
  const auto places = scenario_.board.type->corners(scenario_.board);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto pixel =
        camera.camera.project(T_camera_board * Eigen::Vector3d(places[i].x(), places[i].y(), 0));
    if (!pixel || !camera.camera.contains(*pixel, 3)) continue;
    observation.corners.push_back({static_cast<int>(i), *pixel + Eigen::Vector2d(noise(rng_), noise(rng_)),
                                   Eigen::Matrix2d::Identity() * sigma * sigma});
  }
  const bool whole = observation.corners.size() == places.size();
  if (observation.corners.size() < 6 || (scenario_.board.type->name() == "checkerboard" && !whole))
    observation.corners.clear();
  return observation;
}

/// The returns of one revolution whose middle is at `time`, each from the board where it was at that moment.
LidarSight FeatureHost::plate_sight(const SimulatedLidar& lidar, double time) {
  const Plate plate{scenario_.board.extent(), scenario_.bend};
  const auto T_lidar_board = [&](double at) { return lidar.T_rig_lidar.inverse() * motion_.at(at); };
  const double begin = time - 0.5 / lidar.beams.rate;
  LidarSight sight;
  std::vector<Eigen::Vector3d> points;
  for (const PlateHit& hit :
       cast_on_plate(lidar.beams, draw_azimuth(lidar, rng_), T_lidar_board(time), plate)) {
    const std::size_t beam =
        static_cast<std::size_t>(hit.ring) * static_cast<std::size_t>(lidar.beams.columns) +
        static_cast<std::size_t>(hit.column);
    const Pose T_board_lidar = T_lidar_board(begin + lidar.beams.time[beam]).inverse();
    const auto range = plate.intersect(T_board_lidar * hit.ray.origin, T_board_lidar.R * hit.ray.direction);
    if (!range) continue;
    const double reflectivity = print_reflectivity(scenario_.board, hit.p_board);
    const double measured = measured_range(lidar, *range, reflectivity, rng_);
    points.push_back(hit.ray.origin + measured * hit.ray.direction);
    sight.on_board.push_back({points.back().cast<float>(), static_cast<std::uint16_t>(hit.ring),
                              BoardReturn::no_intensity,
                              static_cast<float>(beam_height(lidar.beams, hit.ring))});
  }
  if (points.size() < 12) return {};
  sight.plane = facing_origin(fit_plane(points, &sight.rms));
  // The rectangle's fit is off by what rings leave open.
  std::normal_distribution<double> noise(0, 0.008);
  const Eigen::Vector2d& middle = plate.outline.center;
  sight.center = T_lidar_board(time) * Eigen::Vector3d(middle.x() + noise(rng_), middle.y() + noise(rng_), 0);
  sight.score = 0.7;
  return sight;
}

/// A plane of about the board's size.
LidarSight FeatureHost::patch(const Pose& T_lidar_patch, double width, double height) {
  LidarSight sight;
  std::normal_distribution<double> noise(0, 0.01);
  std::vector<Eigen::Vector3d> points;
  for (double x = -width / 2; x <= width / 2; x += width / 10) {
    for (double y = -height / 2; y <= height / 2; y += height / 10) {
      const Eigen::Vector3d p = T_lidar_patch * Eigen::Vector3d(x, y, 0);
      points.push_back(p + noise(rng_) * p.normalized());
      sight.on_board.push_back({points.back().cast<float>(), static_cast<std::uint16_t>(20 + 50 * y)});
    }
  }
  sight.plane = facing_origin(fit_plane(points, &sight.rms));
  sight.center = T_lidar_patch.t;
  sight.score = 0.5;
  return sight;
}

LidarObservation FeatureHost::scan(int index, double time) {
  LidarObservation observation;
  observation.lidar = index;
  observation.time = stamp(time);
  observation.scan = scan_;
  const SimulatedLidar& lidar = scenario_.lidars.at(lidars_[static_cast<std::size_t>(index)]);
  const auto add = [&](LidarSight sight, double novelty) {
    if (sight.on_board.empty()) return;
    observation.sights.push_back(std::move(sight));
    // In the first second nothing is known to be new.
    observation.novelty.push_back(time < 1 ? std::nan("") : novelty);
  };
  const TrueHold* hold = hold_at(time);
  const bool blind = hold && std::find(options_.blind_holds.begin(), options_.blind_holds.end(), hold->id) !=
                                 options_.blind_holds.end();
  if (!blind) add(plate_sight(lidar, time), 0.95);
  // A cabinet, always there; the chest of who holds the board, as new as the board; somebody who walks by.
  const auto facing = [&](const Eigen::Vector3d& p_rig) {
    Pose T_rig_patch;
    T_rig_patch.R.col(2) = Eigen::Vector3d(p_rig.x(), p_rig.y(), 0).normalized();
    T_rig_patch.R.col(1) = -Eigen::Vector3d::UnitZ();
    T_rig_patch.R.col(0) = T_rig_patch.R.col(1).cross(T_rig_patch.R.col(2));
    T_rig_patch.t = p_rig;
    return lidar.T_rig_lidar.inverse() * T_rig_patch;
  };
  add(patch(facing({3.0, 2.0, 0.1}), 0.45, 0.6), 0);
  const Pose T_rig_board = motion_.at(time);
  const Eigen::Vector3d behind =
      T_rig_board.t + 0.45 * Eigen::Vector3d(T_rig_board.t.x(), T_rig_board.t.y(), 0).normalized() +
      Eigen::Vector3d(0, 0, 0.35);
  add(patch(facing(behind), 0.35, 0.3), 0.9);
  add(patch(facing({2.8 * std::cos(time), 2.8 * std::sin(time), 0}), 0.35, 0.5), 0.9);
  return observation;
}

Result<ViewSights> FeatureHost::store(double time, const StoreView& view) {
  StoredView out;
  out.time = time;
  read_stamps(view, out);
  for (const auto& [name, scan] : view.scans) out.lidars.push_back(name);
  stored.push_back(out);
  ViewSights sights;
  sights.id = view.id;
  const double middle = (out.first + out.last) / 2 - options_.clock_offset;
  for (std::size_t c = 0; c < cameras_.size(); ++c) {
    std::optional<CameraSight>& sight = sights.cameras.emplace_back();
    if (!view.images.contains(cameras_[c])) continue;
    CameraObservation seen = see(static_cast<int>(c), middle);
    if (seen.corners.empty()) continue;
    const Camera& camera = scenario_.cameras.at(cameras_[c]).camera;
    if (const auto pose = estimate_board_pose(scenario_.board, camera, seen.corners))
      sight = CameraSight{seen.corners, *pose};
  }
  for (std::size_t l = 0; l < lidars_.size(); ++l) {
    auto& list = sights.lidars.emplace_back();
    if (view.scans.contains(lidars_[l])) list = scan(static_cast<int>(l), middle).sights;
  }
  return sights;
}

void FeatureHost::handle(double time, const CaptureActions& actions) {
  for (const CaptureAction& action : actions) {
    if (const auto* event = std::get_if<CaptureEvent>(&action)) events.push_back(*event);
    if (const auto* view = std::get_if<StoreView>(&action))
      handle(time, pipeline_.stored(stamp(time), view->id, store(time, *view)));
    if (const auto* solve = std::get_if<SolveViews>(&action);
        solve && static_cast<int>(solve->views->size()) <= options_.solves)
      handle(time, pipeline_.solved(stamp(time), solve->number, solve_views(*solve)));
  }
}

void FeatureHost::run() {
  std::vector<Due> due;
  std::bernoulli_distribution lost(options_.lost);
  const auto schedule = [&](bool picture, int sensor, double period, double phase, double latency) {
    for (double time = phase * period; time < motion_.duration(); time += period) {
      if (!lost(rng_)) due.push_back({time + latency + options_.detection, time, picture, sensor});
    }
  };
  std::uniform_real_distribution<double> phase(0, 1);
  for (std::size_t c = 0; c < cameras_.size(); ++c)
    schedule(true, static_cast<int>(c), 1 / scenario_.carrying.camera_rate, phase(rng_), 0);
  for (std::size_t l = 0; l < lidars_.size(); ++l) {
    const double period = 1 / scenario_.lidars.at(lidars_[l]).beams.rate;
    schedule(false, static_cast<int>(l), period, phase(rng_), period / 2);
  }
  std::stable_sort(due.begin(), due.end(), [](const Due& a, const Due& b) { return a.arrival < b.arrival; });
  for (const Due& next : due) {
    handle(next.arrival, pipeline_.tick(stamp(next.arrival)));
    handle(next.arrival, next.picture ? pipeline_.add(see(next.sensor, next.time))
                                      : pipeline_.add(scan(next.sensor, next.time)));
  }
}

}  // namespace ca2::test
