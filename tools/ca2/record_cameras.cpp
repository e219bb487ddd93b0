#include "tools/ca2/record_cameras.h"

#include <atomic>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/types/counted.h"
#include "drivers/camera/picture_folder.h"
#include "tools/ca2/camera_source_text.h"
#include "tools/ca2/interrupt.h"

namespace ca2 {
namespace {

using Clock = std::chrono::steady_clock;
namespace fs = std::filesystem;

/// A device that is recorded: its imagers' folders, and what became of it.
struct Recorded {
  std::unique_ptr<CameraSource> source;
  std::vector<fs::path> folders;   ///< by stream; empty: not recorded
  std::vector<std::string> names;  ///< likewise
  std::vector<std::uint64_t> written;
  Result<void> result;
};

Result<std::map<std::string, RigCamera>> parse_cameras(const std::vector<std::string>& words) {
  std::map<std::string, RigCamera> cameras;
  for (const std::string& word : words) {
    const std::size_t equals = word.find('=');
    const std::string name = word.substr(0, equals);
    if (equals == std::string::npos || !valid_sensor_name(name)) {
      return fail(ErrorCode::usage, word, "is no camera to record",
                  "write NAME=driver:option=value,option=value");
    }
    const auto source = parse_camera_source(word.substr(equals + 1));
    if (!source) return fail(source.error());
    RigCamera camera;
    camera.source = *source;
    if (!cameras.emplace(name, camera).second)
      return fail(ErrorCode::usage, word, "there are two cameras '" + name + "'");
  }
  return cameras;
}

Result<Recorded> open_device(const CameraDevice& device, const fs::path& output) {
  auto source = open_camera(device.source);
  if (!source) return fail(source.error());
  Recorded recorded;
  const std::size_t streams = (*source)->streams().size();
  recorded.folders.resize(streams);
  recorded.names.resize(streams);
  recorded.written.resize(streams);
  for (const auto& [imager, name] : device.cameras) {
    const auto stream = find_stream(**source, imager);
    if (!stream) return fail(stream.error());
    const fs::path folder = output / "cameras" / name;
    std::error_code code;
    fs::create_directories(folder, code);
    if (code) return fail(ErrorCode::cannot_create, folder.string(), code.message());
    if (!fs::is_empty(folder, code)) {
      return fail(ErrorCode::cannot_create, folder.string(), "has pictures already",
                  "choose another --output");
    }
    recorded.folders[static_cast<std::size_t>(*stream)] = folder;
    recorded.names[static_cast<std::size_t>(*stream)] = name;
  }
  recorded.source = std::move(*source);
  return recorded;
}

void record(Recorded& recorded, Clock::time_point end, std::atomic<bool>& failed) {
  recorded.result = recorded.source->start();
  while (recorded.result && Clock::now() < end && !Interrupt::raised() && !failed) {
    const CameraPoll poll = recorded.source->next(std::chrono::milliseconds(200));
    if (poll.event == CameraEvent::end) break;
    if (poll.event == CameraEvent::lost) {
      recorded.result = fail(ErrorCode::unavailable, recorded.source->description(), poll.reason);
    }
    if (poll.event != CameraEvent::frame) continue;
    const auto stream = static_cast<std::size_t>(poll.frame.stream);
    if (stream >= recorded.folders.size() || recorded.folders[stream].empty()) continue;
    recorded.result = save_picture(recorded.folders[stream], poll.frame.time, *poll.frame.image);
    if (recorded.result) ++recorded.written[stream];
  }
  if (!recorded.result) failed = true;
  recorded.source->stop();
}

void print(const std::vector<Recorded>& all, bool as_json) {
  nlohmann::ordered_json report = nlohmann::ordered_json::object();
  for (const Recorded& recorded : all) {
    for (std::size_t i = 0; i < recorded.names.size(); ++i) {
      if (recorded.names[i].empty()) continue;
      const CameraCounters counters = recorded.source->counters_of(static_cast<int>(i));
      report[recorded.names[i]] = {{"written", recorded.written[i]},
                                   {"incomplete", counters.incomplete},
                                   {"missed", counters.missed},
                                   {"overrun", counters.overrun}};
      if (as_json) continue;
      std::printf("%s: %s; %llu incomplete, %llu missed, %llu too late\n", recorded.names[i].c_str(),
                  counted(recorded.written[i], "picture").c_str(),
                  static_cast<unsigned long long>(counters.incomplete),
                  static_cast<unsigned long long>(counters.missed),
                  static_cast<unsigned long long>(counters.overrun));
    }
  }
  if (as_json) std::puts(report.dump(2).c_str());
}

}  // namespace

Result<int> record_cameras(const CameraRecordingOptions& options) {
  const auto cameras = parse_cameras(options.cameras);
  if (!cameras) return fail(cameras.error());
  const auto devices = camera_devices(*cameras);
  if (!devices) return fail(devices.error());
  std::vector<Recorded> all;
  for (const CameraDevice& device : *devices) {
    auto recorded = open_device(device, options.output);
    if (!recorded) return fail(recorded.error());
    all.push_back(std::move(*recorded));
  }
  const Interrupt interrupt;
  const std::chrono::duration<double> limit(options.duration > 0 ? options.duration : 1e9);  // 30 years
  const auto end = Clock::now() + std::chrono::duration_cast<Clock::duration>(limit);
  std::atomic<bool> failed{false};
  {
    std::vector<std::jthread> threads;
    for (Recorded& recorded : all) threads.emplace_back([&] { record(recorded, end, failed); });
  }
  print(all, options.as_json);
  std::uint64_t written = 0;
  for (const Recorded& recorded : all) {
    if (!recorded.result) return fail(recorded.result.error());
    for (const std::uint64_t count : recorded.written) written += count;
  }
  if (written == 0) return fail(ErrorCode::unavailable, options.output.string(), "no picture came");
  return 0;
}

}  // namespace ca2
