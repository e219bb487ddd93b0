// What takes the machine's time, once each, on inputs that are made here: for instruction_counts.sh to count.
// A function by the name of hot_NAME is run for every NAME given.
#include <cstdio>
#include <filesystem>
#include <functional>
#include <opencv2/core/utility.hpp>
#include <random>
#include <string_view>

#include "core/lidar/board_candidate.h"
#include "core/solve/calibrate.h"
#include "drivers/lidar/encode.h"
#include "drivers/lidar/model.h"
#include "drivers/lidar/ouster/decoder.h"
#include "drivers/lidar/velodyne/decoder.h"
#include "tools/ca2/bench_lidar_scenes.h"
#include "tools/ca2/bench_pictures.h"
#include "tools/sim/calibration_trials.h"
#include "tools/sim/feature_sights.h"

namespace {

using namespace ca2;

struct Work {
  std::unique_ptr<PacketDecoder> decoder;
  std::vector<EncodedPacket> packets;
  std::unique_ptr<BoardFinder> finder;
  Scan scan;
  Board board;
  Image picture;
  Rig rig;
  std::vector<ViewSights> views;
};

std::size_t decode(const Work& work) {
  LidarCounters counters;
  std::size_t points = 0;
  const LidarSink sink = [&](LidarScan&& scan) { points += scan.scan.size(); };
  for (const EncodedPacket& packet : work.packets) {
    Datagram datagram;
    datagram.time = packet.time;
    datagram.payload = packet.bytes;
    work.decoder->push(datagram, counters, sink);
  }
  work.decoder->flush(counters, sink);
  return points;
}

}  // namespace

// By names that valgrind knows them by. Each says how much it did, which must not be nothing.
extern "C" {
__attribute__((noinline)) std::size_t hot_decode_ouster(Work& work) {
  return decode(work);
}
__attribute__((noinline)) std::size_t hot_decode_velodyne(Work& work) {
  return decode(work);
}
__attribute__((noinline)) std::size_t hot_find_in_scan(Work& work) {
  return work.finder->find(work.scan).size();
}
__attribute__((noinline)) std::size_t hot_find_in_picture(Work& work) {
  return work.board.type->find(work.board, work.picture).size();
}
__attribute__((noinline)) std::size_t hot_solve(Work& work) {
  return calibrate(work.rig, work.views, {}) ? work.views.size() : 0;
}
}

namespace {

EncoderScan returns_everywhere(int rings, int columns) {
  EncoderScan scan;
  scan.rings = rings;
  scan.columns = columns;
  scan.range[0].resize(static_cast<std::size_t>(rings) * static_cast<std::size_t>(columns));
  std::mt19937_64 random(1);
  for (float& range : scan.range[0])
    range = random() % 8 == 0 ? 0.0f : 2 + static_cast<float>(random() % 5000) * 1e-3f;
  return scan;
}

Work ouster_work() {
  const OusterMetadata metadata =
      nominal_ouster_metadata(*(*find_lidar_model("OS0-128"))->ouster(), 1024, 10, "RNG19_RFL8_SIG16_NIR16");
  OusterOptions options;
  options.extra_fields = true;
  Work work;
  work.decoder = std::make_unique<OusterDecoder>(metadata, options);
  for (const std::uint32_t frame : {1, 2}) {
    EncoderScan scan = returns_everywhere(128, 1024);
    scan.frame_id = frame;
    work.packets = encode_ouster(metadata, scan);
    if (frame == 1) decode(work);  // finds the memory
  }
  return work;
}

Work velodyne_work() {
  const VelodyneModel& model = *(*find_lidar_model("VLP-16"))->velodyne();
  Work work;
  work.decoder = std::make_unique<VelodyneDecoder>(model, model.factory, VelodyneOptions{});
  VelodyneEncoder encoder(model, model.factory, {});
  for (const int revolution : {1, 2}) {
    EncoderScan scan = returns_everywhere(model.lasers, static_cast<int>(0.1 / model.cycle));
    scan.start = revolution * 100'000'000ll;
    work.packets = encoder.push(scan);
    if (revolution == 1) decode(work);  // finds the memory, and makes the tables
  }
  return work;
}

Work scan_work() {
  Work work;
  work.finder = std::make_unique<BoardFinder>(lidar_bench_board());
  auto scenes = lidar_bench_scenes(1);
  if (scenes) work.scan = std::move(scenes->front().present);
  return work;
}

Work picture_work() {
  Work work;
  work.board = bench_board();
  const BenchCamera camera = bench_cameras().front();
  std::mt19937_64 random(1);
  const Pose T_camera_board = random_board_pose(work.board, camera.camera, camera.places, random);
  work.picture = board_picture(work.board, camera.camera, T_camera_board, random);
  return work;
}

Work solve_work() {
  Work work;
  const auto file =
      read_scenario(std::filesystem::path(CA2_SOURCE_DIR) / "config/scenarios/vlp16_blackfly.yaml");
  if (!file) return work;
  const auto pool = simulate_pool(file->scenario, 10);
  work.rig = rig_of(file->scenario);
  if (!pool) return work;
  if (auto views = sights_of(work.rig, *pool)) work.views = *std::move(views);
  return work;
}

struct Hot {
  const char* name;
  Work (*prepare)();
  std::size_t (*run)(Work&);
};
constexpr Hot all[] = {{"decode_ouster", ouster_work, hot_decode_ouster},
                       {"decode_velodyne", velodyne_work, hot_decode_velodyne},
                       {"find_in_scan", scan_work, hot_find_in_scan},
                       {"find_in_picture", picture_work, hot_find_in_picture},
                       {"solve", solve_work, hot_solve}};

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  if (argc != 2) {
    for (const Hot& hot : all) std::puts(hot.name);
    return 64;
  }
  for (const Hot& hot : all) {
    if (hot.name != std::string_view(argv[1])) continue;
    Work work = hot.prepare();
    const std::size_t done = hot.run(work);
    std::printf("%s %zu\n", hot.name, done);
    return done == 0 ? 1 : 0;
  }
  return 64;
}
