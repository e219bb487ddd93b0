/// @file `ca2 record`: datagrams into capture files and pictures into a recording without the daemon, or all
/// that the daemon's sensors give.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>

#include "drivers/net/pcap_writer.h"
#include "drivers/net/udp_source.h"
#include "tools/ca2/camera_source_text.h"
#include "tools/ca2/command.h"
#include "tools/ca2/daemon_link.h"
#include "tools/ca2/interrupt.h"
#include "tools/ca2/number_in.h"
#include "tools/ca2/packet_report.h"
#include "tools/ca2/record_cameras.h"

namespace ca2 {
namespace {

using Clock = std::chrono::steady_clock;

struct PacketOptions {
  std::vector<std::uint16_t> ports{7502, 7503, 2368, 8308};
  std::vector<std::string> sources;
  std::string address, group, interface;
  std::filesystem::path output;  // FILE.pcap, or a directory for a file per port
  double duration = 0;           // s; 0: until Ctrl-C
  bool overwrite = false, share = false, as_json = false;
};

/// The files of a recording: one, or one per port, made when the port's first datagram comes.
class Files {
 public:
  explicit Files(const PacketOptions& options) : options_(options) {
    writer_options_.overwrite = options.overwrite;
    writer_options_.destination = options.group;
  }

  /// Makes the file or the directory now, so that a wrong path is told before anything is received.
  Result<void> prepare() {
    if (single()) {
      auto writer = PcapWriter::create(options_.output, writer_options_);
      if (!writer) return fail(writer.error());
      writers_.emplace(0, std::move(*writer));
      return {};
    }
    std::error_code code;
    std::filesystem::create_directories(options_.output, code);
    if (code) return fail(ErrorCode::cannot_create, options_.output.string(), code.message());
    return {};
  }

  Result<void> write(const Datagram& datagram) {
    const std::uint16_t key = single() ? 0 : datagram.destination_port;
    auto found = writers_.find(key);
    if (found == writers_.end()) {
      const auto file = options_.output / ("udp-" + std::to_string(key) + ".pcap");
      auto writer = PcapWriter::create(file, writer_options_);
      if (!writer) return fail(writer.error());
      found = writers_.emplace(key, std::move(*writer)).first;
    }
    return found->second.write(datagram);
  }

  Result<void> close() {
    Result<void> result;
    for (auto& [port, writer] : writers_) {
      if (auto closed = writer.close(); !closed) result = closed;
    }
    return result;
  }

  std::uint64_t bytes() const {
    std::uint64_t sum = 0;
    for (const auto& [port, writer] : writers_) sum += writer.bytes();
    return sum;
  }

 private:
  bool single() const { return options_.output.extension() == ".pcap"; }

  const PacketOptions& options_;
  PcapWriterOptions writer_options_;
  std::map<std::uint16_t, PcapWriter> writers_;
};

/// A line that is written over, on terminals only.
class Progress {
 public:
  void show(const PacketCounters& counters, std::uint64_t bytes) {
    const auto now = Clock::now();
    if (!terminal_ || now < next_) return;
    next_ = now + std::chrono::milliseconds(500);
    const double seconds = std::chrono::duration<double>(now - start_).count();
    std::fprintf(stderr, "\r\033[K%.1f s  %llu datagrams  %.1f MB  %llu lost", seconds,
                 static_cast<unsigned long long>(counters.datagrams), static_cast<double>(bytes) / 1e6,
                 static_cast<unsigned long long>(counters.lost()));
    std::fflush(stderr);
    shown_ = true;
  }
  ~Progress() {
    if (shown_) std::fprintf(stderr, "\r\033[K");
  }

 private:
  bool terminal_ = isatty(STDERR_FILENO) != 0, shown_ = false;
  Clock::time_point start_ = Clock::now(), next_ = start_;
};

Result<void> record(const PacketOptions& options, UdpSource& source, Files& files) {
  const Interrupt interrupt(&source);
  const auto limit = options.duration > 0 ? std::chrono::duration<double>(options.duration)
                                          : std::chrono::duration<double>(1e9);  // 30 years
  const auto end = Clock::now() + std::chrono::duration_cast<Clock::duration>(limit);
  Progress progress;
  while (Clock::now() < end) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - Clock::now());
    // Half a second at most, for the progress line.
    const Result<PacketBatch> batch = source.next_batch(std::min(left, std::chrono::milliseconds(500)));
    if (!batch) return fail(batch.error());
    for (const Datagram& datagram : batch->datagrams) {
      if (auto written = files.write(datagram); !written) return written;
    }
    if (batch->event == PacketEvent::stopped) break;
    progress.show(source.counters(), files.bytes());
  }
  return {};
}

Result<int> run_packets(const PacketOptions& options) {
  UdpSourceOptions source_options;
  source_options.ports = options.ports;
  source_options.sources = options.sources;
  source_options.socket.address = options.address;
  source_options.socket.multicast_group = options.group;
  source_options.socket.interface = options.interface;
  source_options.socket.share_port = options.share;
  const auto source = UdpSource::open(source_options);
  if (!source) return fail(source.error());
  const std::string& warning = (*source)->sockets()[0].warning;
  if (!warning.empty()) std::fprintf(stderr, "ca2: %s\n", warning.c_str());
  Files files(options);
  if (auto ready = files.prepare(); !ready) return fail(ready.error());

  Result<void> done = record(options, **source, files);
  const Result<void> closed = files.close();
  if (done && !closed) done = closed;
  const PacketCounters& counters = (*source)->counters();
  if (options.as_json) {
    const nlohmann::json report = {{"output", options.output.string()},
                                   {"file_bytes", files.bytes()},
                                   {"counters", counters_json(counters)}};
    std::printf("%s\n", report.dump(2, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
  } else {
    print_counters(stdout, counters);
  }
  if (!done) return fail(done.error());
  if (counters.datagrams == 0) {
    return fail(ErrorCode::unavailable, options.output.string(), "nothing was received",
                "`ca2 sensors` listens on the usual ports");
  }
  return 0;
}

struct DaemonRecording {
  DaemonAddress address;
  std::string name;
  bool as_json = false;
};

Result<int> call_recorder(const DaemonRecording& options, bool start) {
  const nlohmann::json arguments = start ? nlohmann::json{{"name", options.name}} : nlohmann::json::object();
  const Result<nlohmann::json> reply = call_daemon(options.address, start ? "record_start" : "record_stop",
                                                   arguments, std::chrono::seconds(30));
  if (!reply) return fail(reply.error());
  const std::string directory = reply->value("recording", "");
  if (options.as_json) {
    std::printf("%s\n", reply->dump(2).c_str());
  } else if (start) {
    std::printf("recording to %s\n", directory.c_str());
    if (const std::string caveat = reply->value("caveat", ""); !caveat.empty())
      std::printf("%s\n", caveat.c_str());
  } else {
    std::printf("recorded %s, %llu inputs dropped\n", directory.c_str(), reply->value("dropped", 0ull));
  }
  return 0;
}

}  // namespace

CommandBody setup_record(CLI::App& app) {
  app.require_subcommand(1);
  CLI::App* packets =
      app.add_subcommand("packets", "Raw LiDAR datagrams into capture files; needs no daemon");
  auto options = std::make_shared<PacketOptions>();
  packets->add_option("--port", options->ports, "UDP ports")
      ->capture_default_str()
      ->check(number_in(1, 65535));
  packets->add_option("--output", options->output, "FILE.pcap, or a directory for one file per port")
      ->required();
  packets->add_option("--duration", options->duration, "Seconds; default: until Ctrl-C")->check(seconds());
  packets->add_option("--source", options->sources, "Only from these addresses");
  packets->add_option("--address", options->address, "Local address to receive on; default: all");
  packets->add_option("--group", options->group, "Multicast group to join");
  packets->add_option("--interface", options->interface, "Interface for the group");
  packets->add_flag("--overwrite", options->overwrite, "Replace existing files");
  packets->add_flag("--share", options->share, "Share the ports with programs that share them too");
  packets->add_flag("--json", options->as_json, "Report for programs");
  CLI::App* cameras = app.add_subcommand("cameras", "Pictures into a recording's folders; needs no daemon");
  auto camera_options = std::make_shared<CameraRecordingOptions>();
  cameras
      ->add_option("camera", camera_options->cameras, "NAME=driver:option=value,option=value, one or several")
      ->required();
  cameras->add_option("--output", camera_options->output, "The recording: OUTPUT/cameras/NAME/<utc_ns>.png")
      ->required();
  cameras->add_option("--duration", camera_options->duration, "Seconds; default: until Ctrl-C")
      ->check(seconds());
  cameras->add_flag("--json", camera_options->as_json, "Report for programs");
  cameras->footer(camera_drivers_help());
  auto body = std::make_shared<CommandBody>([options, camera_options, cameras] {
    return cameras->parsed() ? record_cameras(*camera_options) : run_packets(*options);
  });
  const auto add = [&](const char* name, const char* help, bool start) {
    CLI::App* sub = app.add_subcommand(name, help);
    auto recording = std::make_shared<DaemonRecording>();
    add_daemon_options(*sub, recording->address);
    if (start) sub->add_option("name", recording->name, "Name of the recording; default: the time");
    sub->add_flag("--json", recording->as_json, "For programs");
    sub->callback([body, recording, start] {
      *body = [recording, start] { return call_recorder(*recording, start); };
    });
  };
  add("start", "Have the daemon record what its sensors give", true);
  add("stop", "End the daemon's recording", false);
  return [body] { return (*body)(); };
}

}  // namespace ca2
