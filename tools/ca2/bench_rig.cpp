/// @file `ca2 bench rig`: what the daemon costs on a whole rig at its true rates: cameras over GigE Vision,
/// LiDARs over UDP, in a network of its own, from a recording of a person who carries the board.
#include <arpa/inet.h>
#include <fcntl.h>
#include <linux/capability.h>
#include <net/if.h>
#include <net/route.h>
#include <sched.h>
#include <signal.h>
#include <spawn.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/io/files.h"
#include "core/types/text.h"
#include "drivers/camera/host_time.h"
#include "drivers/net/unique_fd.h"
#include "drivers/recording/recording.h"
#include "messages/control/client.h"
#include "tools/ca2/bench.h"
#include "tools/ca2/process_load.h"

namespace ca2 {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

constexpr double camera_rate = 30;                         // pictures per second
constexpr std::int64_t head_start = 30'000'000'000;        // ns: until everything is open
constexpr std::chrono::seconds settling{2}, measuring{9};  // of the recording

/// Programs that end with it.
class Processes {
 public:
  explicit Processes(fs::path programs) : programs_(std::move(programs)) {}
  Processes(const Processes&) = delete;
  Processes& operator=(const Processes&) = delete;
  ~Processes() {
    for (const pid_t process : started_) ::kill(process, SIGTERM);
    for (const pid_t process : started_) ::waitpid(process, nullptr, 0);
  }

  Result<pid_t> start(std::vector<std::string> words, const fs::path& log) {
    const std::string program = programs_ / words[0];
    if (::access(program.c_str(), X_OK) != 0) {
      return fail(ErrorCode::unavailable, program, "is not there",
                  "`ca2 bench rig` needs it beside ca2: cmake --build --target ca2d fake_gige_camera");
    }
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    for (const int output : {1, 2}) {
      posix_spawn_file_actions_addopen(&actions, output, log.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
    }
    pid_t process = -1;
    const int code = ::posix_spawn(&process, program.c_str(), &actions, nullptr, pointers.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (code != 0) return fail(ErrorCode::unavailable, program, std::strerror(code));
    started_.push_back(process);
    return process;
  }

 private:
  fs::path programs_;
  std::vector<pid_t> started_;
};

/// A network namespace with 127.0.0.1 to 127.0.0.`addresses` and a route for LCM.
Result<void> enter_own_network(int addresses) {
  const auto failed = [](const char* what) {
    return fail(ErrorCode::no_permission, what, std::strerror(errno),
                "the benchmark needs a network namespace of its own: run it as root");
  };
  if (::unshare(CLONE_NEWNET) != 0 && ::unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0) return failed("unshare");
  const UniqueFd fd(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  for (int i = 1; i <= addresses; ++i) {
    ifreq request{};
    const std::string name = i == 1 ? "lo" : "lo:" + std::to_string(i);  // the others are its aliases'
    name.copy(request.ifr_name, sizeof request.ifr_name - 1);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = ::htonl(INADDR_LOOPBACK - 1 + static_cast<unsigned>(i));
    std::memcpy(&request.ifr_addr, &address, sizeof address);
    if (::ioctl(fd.get(), SIOCSIFADDR, &request) != 0) return failed(name.c_str());
    request.ifr_flags = IFF_UP | IFF_RUNNING | IFF_LOOPBACK | IFF_MULTICAST;
    if (::ioctl(fd.get(), SIOCSIFFLAGS, &request) != 0) return failed(name.c_str());
  }
  rtentry multicast{};
  const auto address = [](sockaddr& out, in_addr_t value) {
    sockaddr_in in{};
    in.sin_family = AF_INET;
    in.sin_addr.s_addr = ::htonl(value);
    std::memcpy(&out, &in, sizeof in);
  };
  address(multicast.rt_dst, 0xe0000000);
  address(multicast.rt_genmask, 0xf0000000);
  address(multicast.rt_gateway, INADDR_ANY);
  char loopback[] = "lo";
  multicast.rt_dev = loopback;
  multicast.rt_flags = RTF_UP;
  if (::ioctl(fd.get(), SIOCADDRT, &multicast) != 0) return failed("route for multicast");
  return {};
}

/// The recording's rig with sources that are the players'.
std::string live_config(const Recording& recording, const fs::path& directory, int packet_size) {
  Rig rig = recording.rig;
  int address = 2;
  for (auto& [name, camera] : rig.cameras) {
    camera.source = {{"driver", "aravis"},
                     {"id", "127.0.0." + std::to_string(address++)},
                     {"width", std::to_string(camera.width)},
                     {"height", std::to_string(camera.height)},
                     {"frame_rate", formatted("%g", camera_rate)},
                     {"packet_size", std::to_string(packet_size)},
                     {"silence", "5"}};
  }
  for (auto& [name, lidar] : rig.lidars) {
    lidar.source = {{"driver", lidar.metadata.empty() ? "velodyne" : "ouster"}};
    for (std::string* file : {&lidar.metadata, &lidar.calibration}) {
      if (!file->empty()) *file = fs::absolute(recording.directory / *file).string();
    }
  }
  return write_rig(rig) + "state: {directory: \"" + (directory / "state").string() +
         "\"}\ncontrol: {socket: \"" + (directory / "control.sock").string() + "\"}\n";
}

/// Tries until the daemon answers and every sensor runs.
Result<nlohmann::json> status_of(const fs::path& socket, bool all_running, std::chrono::seconds patience) {
  const auto end = std::chrono::steady_clock::now() + patience;
  for (;;) {
    auto client = control::Client::connect(socket);
    Result<nlohmann::json> status =
        client ? client->call("status", nlohmann::json::object(), std::chrono::seconds(5))
               : Result<nlohmann::json>(fail(client.error()));
    bool good = status.has_value();
    if (good && all_running) {
      for (const auto& sensor : status->at("sensors")) good = good && sensor.at("supervision") == "running";
    }
    if (good || std::chrono::steady_clock::now() > end) return status;
    std::this_thread::sleep_for(milliseconds(100));
  }
}

struct Losses {
  double frames = 0, lost = 0, shed = 0;
};

Losses losses(const nlohmann::json& status) {
  Losses sum;
  for (const auto& sensor : status.at("sensors")) {
    sum.frames += sensor.at("frames").get<double>();
    sum.lost += sensor.at("lost").get<double>();
    sum.shed += sensor.at("shed").get<double>();
  }
  return sum;
}

/// ms of CPU per view that was stored meanwhile, by what it went into; null where none was.
nlohmann::json store_cost(const nlohmann::json& before, const nlohmann::json& after) {
  const nlohmann::json &from = before.at("store_cost"), &to = after.at("store_cost");
  const double views = to.at("views").get<double>() - from.at("views").get<double>();
  if (views <= 0) return nullptr;
  const auto each = [&](const char* what) {
    return 1e3 * (to.at(what).get<double>() - from.at(what).get<double>()) / views;
  };
  return {{"saving", each("saving")}, {"searching", each("searching")}};
}

Result<nlohmann::json> measure(const Recording& recording, const fs::path& directory, int packet_size) {
  const fs::path log = directory / "log", socket = directory / "control.sock";
  std::error_code error;
  Processes processes(fs::read_symlink("/proc/self/exe", error).parent_path());
  if (const auto written =
          write_atomically(directory / "ca2d.yaml", live_config(recording, directory, packet_size));
      !written) {
    return fail(written.error());
  }
  const std::string shift = std::to_string(utc_now() + head_start - recording.start);
  int address = 2;
  for (const auto& [name, camera] : recording.rig.cameras) {
    const auto started = processes.start({"fake_gige_camera", "127.0.0." + std::to_string(address++), name,
                                          "0", recording.pictures(name).string(), shift, "at_once"},
                                         log);
    if (!started) return fail(started.error());
  }
  const auto daemon = processes.start({"ca2d", "--config", (directory / "ca2d.yaml").string()}, log);
  if (!daemon) return fail(daemon.error());
  if (const auto running = status_of(socket, true, std::chrono::seconds(60)); !running) {
    return fail(running.error());
  }
  for (const auto& [name, lidar] : recording.rig.lidars) {
    const auto player = processes.start(
        {"ca2", "play", recording.packets(name).string(), "--to", "127.0.0.1", "--shift", shift}, log);
    if (!player) return fail(player.error());
  }
  const std::int64_t begin = recording.start + std::stoll(shift);
  std::this_thread::sleep_for(std::chrono::nanoseconds(std::max<std::int64_t>(0, begin - utc_now())) +
                              settling);
  const auto before = status_of(socket, false, std::chrono::seconds(5));
  const ProcessLoad first = process_load(*daemon);
  const auto first_time = std::chrono::steady_clock::now();
  std::this_thread::sleep_for(measuring);
  const ProcessLoad last = process_load(*daemon);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - first_time).count();
  const auto after = status_of(socket, false, std::chrono::seconds(5));
  if (!before || !after) return fail((before ? after : before).error());

  const Losses lost_before = losses(*before), lost_after = losses(*after);
  nlohmann::json threads;
  for (const auto& [name, cpu] : last.cpu_by_thread) {
    const auto was = first.cpu_by_thread.find(name);
    threads[name] = 100 * (cpu - (was == first.cpu_by_thread.end() ? 0 : was->second)) / seconds;
  }
  return nlohmann::json{{"packet_size", packet_size},
                        {"seconds", seconds},
                        {"cpu_percent", 100 * (last.cpu - first.cpu) / seconds},
                        {"threads_percent", threads},
                        {"resident_mb", 1e-6 * last.resident},
                        {"most_resident_mb", 1e-6 * last.most_resident},
                        {"frames", lost_after.frames - lost_before.frames},
                        {"lost", lost_after.lost - lost_before.lost},
                        {"shed", lost_after.shed - lost_before.shed},
                        {"views", after->at("views")},
                        {"view_ms", store_cost(*before, *after)},
                        {"sensors", after->at("sensors")}};
}

}  // namespace

Result<int> bench_rig(const BenchOptions& options) {
  const Result<Recording> recording = open_recording(options.data);
  if (!recording) {
    return fail(ErrorCode::usage, options.data.string(), "--data must be a recording",
                "ca2 simulate config/scenarios/whole_rig.yaml --recording --output DIR makes one");
  }
  // As the unit runs it: without the rings of raw sockets, which Aravis takes where it may.
  ::prctl(PR_CAPBSET_DROP, CAP_NET_RAW);
  if (auto own = enter_own_network(1 + static_cast<int>(recording->rig.cameras.size())); !own) {
    return fail(own.error());
  }
  nlohmann::json rows = nlohmann::json::array();
  for (const int packet_size : {8000, 1400}) {
    char directory[] = "/tmp/ca2-bench-rig-XXXXXX";
    if (!::mkdtemp(directory)) return fail(ErrorCode::cannot_create, directory, std::strerror(errno));
    const auto row = measure(*recording, directory, packet_size);
    if (!row) return fail(row.error());
    std::error_code ignored;
    fs::remove_all(directory, ignored);
    rows.push_back(*row);
    if (options.json) continue;
    const nlohmann::json& values = rows.back();
    std::printf("%zu cameras at %g Hz in packets of %d bytes, %zu LiDARs; ca2d over %.0f s:\n",
                recording->rig.cameras.size(), camera_rate, packet_size, recording->rig.lidars.size(),
                values["seconds"].get<double>());
    std::printf(
        "  CPU %.0f %% of a core, RSS %.0f MB (most %.0f MB), %.0f frames, %.0f lost, %.0f not searched, %d "
        "views\n",
        values["cpu_percent"].get<double>(), values["resident_mb"].get<double>(),
        values["most_resident_mb"].get<double>(), values["frames"].get<double>(),
        values["lost"].get<double>(), values["shed"].get<double>(), values["views"].get<int>());
    if (const nlohmann::json& cost = values["view_ms"]; !cost.is_null()) {
      std::printf("  a view: %.0f ms of CPU until it is saved, %.0f ms for its features\n",
                  cost["saving"].get<double>(), cost["searching"].get<double>());
    }
    for (const auto& [name, percent] : values["threads_percent"].items()) {
      if (percent.get<double>() >= 0.05) std::printf("  %6.1f %%  %s\n", percent.get<double>(), name.c_str());
    }
  }
  if (options.json) std::printf("%s\n", rows.dump(2).c_str());
  return 0;
}

}  // namespace ca2
