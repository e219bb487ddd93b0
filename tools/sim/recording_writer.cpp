#include "tools/sim/recording_writer.h"

#include <atomic>
#include <cmath>
#include <mutex>
#include <thread>

#include "core/io/files.h"
#include "drivers/recording/recording.h"
#include "tools/sim/furnishing.h"
#include "tools/sim/packet_writer.h"
#include "tools/sim/picture_sequence.h"
#include "tools/sim/truth_file.h"

namespace ca2 {
namespace {

namespace fs = std::filesystem;

/// A picture to be rendered.
struct Exposure {
  std::string camera;
  double time = 0;         ///< s, true
  std::int64_t stamp = 0;  ///< ns UTC, as the host's clock says
  std::uint64_t seed = 0;
};

/// One trigger for all cameras, or each begins at its own moment.
std::vector<Exposure> plan_exposures(const Scenario& scenario, double duration, std::int64_t start) {
  std::vector<Exposure> exposures;
  const Carrying& carrying = scenario.carrying;
  std::mt19937_64 rng = view_generator(scenario, -1);
  std::uniform_real_distribution<double> phase(0, 1 / carrying.camera_rate);
  double first = phase(rng);
  for (const auto& [name, camera] : scenario.cameras) {
    if (!carrying.triggered) first = phase(rng);
    std::bernoulli_distribution lost(carrying.lost_pictures);
    for (int i = 0; first + i / carrying.camera_rate < duration; ++i) {
      const double time = first + i / carrying.camera_rate;
      const std::uint64_t seed = rng();
      if (lost(rng)) continue;
      exposures.push_back({name, time, start + std::llround(1e9 * (time + carrying.clock_offset)), seed});
    }
  }
  return exposures;
}

/// The first error of several threads.
class FirstError {
 public:
  void set(const Error& error) {
    const std::lock_guard lock(mutex_);
    if (!error_) error_ = error;
    failed = true;
  }
  Result<void> result() const { return error_ ? Result<void>(fail(*error_)) : Result<void>(); }
  std::atomic<bool> failed{false};

 private:
  std::mutex mutex_;
  std::optional<Error> error_;
};

void render_pictures(const Scenario& scenario, const Scene& room, const PersonMotion& motion,
                     const std::vector<Exposure>& exposures, const fs::path& directory,
                     const std::function<void()>& done, std::atomic<std::size_t>& next, FirstError& errors) {
  std::map<std::string, PictureSequence> sequences;
  for (std::size_t i = next++; i < exposures.size() && !errors.failed; i = next++) {
    const Exposure& exposure = exposures[i];
    const auto sequence =
        sequences.try_emplace(exposure.camera, scenario.cameras.at(exposure.camera), room).first;
    Scene scene = room;
    motion.add_to(scene, exposure.time);
    const Result<std::string> png = encode_png(sequence->second.render(scene, exposure.seed));
    if (!png) return errors.set(png.error());
    const fs::path file = directory / "cameras" / exposure.camera / (std::to_string(exposure.stamp) + ".png");
    if (const auto written = write_new(file, *png); !written) return errors.set(written.error());
    done();
  }
}

Result<Rig> make_directories(const ScenarioFile& scenario, const fs::path& directory) {
  std::error_code error;
  if (fs::exists(directory / "recording.yaml", error)) {
    return fail(ErrorCode::cannot_create, directory.string(), "there is a recording already",
                "choose another directory");
  }
  Rig rig = stated_rig(scenario);
  for (const auto& [name, camera] : rig.cameras) {
    fs::create_directories(directory / "cameras" / name, error);
    if (error) return fail(ErrorCode::cannot_create, directory.string(), error.message());
  }
  fs::create_directories(directory / "lidars", error);
  if (error) return fail(ErrorCode::cannot_create, directory.string(), error.message());
  for (auto& [name, lidar] : rig.lidars) {
    if (const auto carried = carry_lidar_files(scenario, name, directory, lidar); !carried)
      return fail(carried.error());
  }
  return rig;
}

}  // namespace

Result<void> write_simulated_recording(const ScenarioFile& file, const fs::path& directory,
                                       const std::function<void(int, int)>& progress) {
  const Scenario& scenario = file.scenario;
  const Result<PersonMotion> motion = PersonMotion::plan(scenario);
  if (!motion) return fail(motion.error());
  const Result<Rig> rig = make_directories(file, directory);
  if (!rig) return fail(rig.error());
  const Scene room = furnish_room(*scenario.room, scenario.seed);
  const std::vector<Exposure> exposures = plan_exposures(scenario, motion->duration(), simulated_start);

  FirstError errors;
  std::mutex mutex;
  int done = 0;
  std::atomic<std::size_t> next_picture{0}, next_lidar{0};
  std::vector<std::string> lidars;
  for (const auto& [name, lidar] : scenario.lidars) lidars.push_back(name);
  const auto one_more = [&] {
    const std::lock_guard lock(mutex);
    if (progress) progress(++done, static_cast<int>(exposures.size()));
  };
  const auto work = [&] {
    for (std::size_t i = next_lidar++; i < lidars.size() && !errors.failed; i = next_lidar++) {
      const auto written = write_packets(file, lidars[i], room, *motion, simulated_start, directory);
      if (!written) errors.set(written.error());
    }
    render_pictures(scenario, room, *motion, exposures, directory, one_more, next_picture, errors);
  };
  {
    std::vector<std::jthread> workers;
    for (unsigned i = 0; i < std::max(1u, std::thread::hardware_concurrency()); ++i)
      workers.emplace_back(work);
  }
  if (const auto result = errors.result(); !result) return result;
  if (const auto written =
          write_atomically(directory / "truth.yaml",
                           truth_text(scenario, {}) + holds_text(scenario, motion->holds(), simulated_start));
      !written) {
    return written;
  }
  // Last: what has a recording.yaml is whole.
  return write_atomically(directory / "recording.yaml", recording_text(*rig, simulated_start));
}

}  // namespace ca2
