#include "tools/ca2/bench_lidar_scenes.h"

#include "drivers/lidar/beam_table.h"
#include "tools/sim/furnishing.h"
#include "tools/sim/lidar_simulator.h"
#include "tools/sim/placement.h"

namespace ca2 {

Board lidar_bench_board() {
  Board board;
  board.type = find_board_type("checkerboard");
  board.columns = 8;
  board.rows = 6;
  board.square = 0.04;
  board.outline = Outline{0.42, 0.297, {0, 0}};
  return board;
}

Result<std::vector<LidarBenchScene>> lidar_bench_scenes(int count) {
  LidarModelSpec model;
  model.model = "OS0-128";
  Result<BeamTable> beams = make_beam_table(model);
  if (!beams) return fail(beams.error());
  Scenario scenario;
  scenario.board = lidar_bench_board();
  scenario.placement = {1.0, 2.5, 0.1, 0.7, 3.0, 10, 3, 25, {}};
  scenario.room = Room{};
  SimulatedLidar& lidar = scenario.lidars["os0"];
  lidar.beams = *std::move(beams);
  lidar.noise.range_sigma = 0.015;
  lidar.noise.divergence = 0.006;
  lidar.noise.free_running_azimuth = false;
  std::vector<LidarBenchScene> scenes;
  for (int i = 0; i < count; ++i) {
    const auto seed = static_cast<std::uint64_t>(100 + i);
    std::mt19937_64 rng(seed);
    const Scene room = furnish_room(*scenario.room, seed);
    const Result<Pose> T_rig_board = place_board(scenario, {"os0"}, rng);
    if (!T_rig_board) return fail(T_rig_board.error());
    LidarBenchScene out;
    out.p_board = T_rig_board->t;
    Scene present = room, absent = room;
    const int board = add_board(present, scenario.board, 0, *T_rig_board);
    const Plate plate = present.solids[static_cast<std::size_t>(board)].plate;
    add_holder(present, *scenario.room, plate, *T_rig_board, rng);
    add_walker(absent, *scenario.room, T_rig_board->t.head<2>(), rng);
    out.present = simulate_scan(lidar, present, rng);
    out.absent = simulate_scan(lidar, absent, rng);
    scenes.push_back(std::move(out));
  }
  return scenes;
}

}  // namespace ca2
