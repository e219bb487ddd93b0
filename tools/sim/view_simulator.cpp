#include "tools/sim/view_simulator.h"

#include <cmath>
#include <utility>

#include "tools/sim/camera_simulator.h"
#include "tools/sim/furnishing.h"
#include "tools/sim/lidar_simulator.h"
#include "tools/sim/placement.h"

namespace ca2 {
namespace {

/// The room with the board in somebody's hands.
Scene with_board(const Scene& room, const Scenario& scenario, const Pose& T_rig_board, std::mt19937_64& rng) {
  Scene scene = room;
  const int board = add_board(scene, scenario.board, scenario.bend, T_rig_board);
  const Plate plate = scene.solids[static_cast<std::size_t>(board)].plate;
  if (scenario.room->person) add_holder(scene, *scenario.room, plate, T_rig_board, rng);
  if (scenario.room->second_person) add_bystander(scene, *scenario.room, T_rig_board.t, rng);
  return scene;
}

/// A place beside the board that neither hides it nor touches who holds it: at least 20 degrees and 0.9 m
/// away.
Result<Pose> place_panel(const Scenario& scenario, const std::vector<std::string>& sensors,
                         const Pose& T_rig_board, std::mt19937_64& rng) {
  constexpr int max_tries = 300;
  for (int i = 0; i < max_tries; ++i) {
    Result<Pose> T_rig_panel = place_board(scenario, sensors, rng);
    if (!T_rig_panel) return T_rig_panel;
    const Eigen::Vector2d a = T_rig_panel->t.head<2>(), b = T_rig_board.t.head<2>();
    const double angle = std::acos(std::min(1.0, a.normalized().dot(b.normalized())));
    if (angle > 0.35 && (a - b).norm() > 0.9) return T_rig_panel;
  }
  return fail(ErrorCode::config, scenario.name, "no place for a wrong panel beside the board",
              "widen the distances, or let wrong objects be of kind moved");
}

}  // namespace

ViewSimulator::ViewSimulator(const Scenario& scenario)
    : scenario_(scenario), room_(furnish_room(*scenario.room, scenario.seed)) {
  for (const auto& [name, camera] : scenario.cameras) rays_.emplace(name, RayGrid(camera.camera));
}

Result<RenderedView> ViewSimulator::render(int id) const {
  std::mt19937_64 rng = view_generator(scenario_, id);
  const std::vector<std::string> sensors = sensors_of_view(scenario_, id);
  RenderedView view;
  if (std::bernoulli_distribution(scenario_.wrong_fraction)(rng)) view.wrong_object = scenario_.wrong_object;
  const Result<Pose> T_rig_board = place_board(scenario_, sensors, rng);
  if (!T_rig_board) return fail(T_rig_board.error());

  Scene scene = with_board(room_, scenario_, *T_rig_board, rng);
  Scene scanned = scene;
  if (view.wrong_object == WrongObject::moved) {
    const Result<Pose> T_rig_later = place_board(scenario_, sensors, rng);
    if (!T_rig_later) return fail(T_rig_later.error());
    scanned = with_board(room_, scenario_, *T_rig_later, rng);
  } else if (view.wrong_object == WrongObject::panel) {
    // Any LiDAR may take it for the board; a camera need not even see it.
    std::vector<std::string> lidars;
    for (const std::string& name : sensors) {
      if (scenario_.lidars.contains(name)) lidars.push_back(name);
    }
    const Result<Pose> T_rig_panel = place_panel(scenario_, lidars, *T_rig_board, rng);
    if (!T_rig_panel) return fail(T_rig_panel.error());
    const int panel = add_panel(scene, scenario_.board, *T_rig_panel, rng);
    const Plate plate = scene.solids[static_cast<std::size_t>(panel)].plate;
    add_holder(scene, *scenario_.room, plate, *T_rig_panel, rng);
    scanned = scene;
  }
  for (const std::string& name : sensors) {
    view.T_sensor_board[name] = scenario_.T_rig_sensor(name).inverse() * *T_rig_board;
    if (const auto camera = scenario_.cameras.find(name); camera != scenario_.cameras.end()) {
      view.images[name] = render_picture(camera->second, rays_.at(name), scene, rng);
    } else {
      view.scans[name] = simulate_scan(scenario_.lidars.at(name), scanned, rng);
    }
  }
  return view;
}

}  // namespace ca2
