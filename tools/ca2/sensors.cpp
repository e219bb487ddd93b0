/// @file `ca2 sensors`: lists the cameras that are there; listens, and names the LiDARs it hears.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <future>
#include <nlohmann/json.hpp>
#include <set>

#include "core/types/counted.h"
#include "drivers/lidar/capture_doubts.h"
#include "drivers/net/pcap_reader.h"
#include "drivers/net/udp_source.h"
#include "drivers/survey/survey.h"
#include "tools/ca2/camera_source_text.h"
#include "tools/ca2/command.h"
#include "tools/ca2/configurable_sensor.h"
#include "tools/ca2/interrupt.h"
#include "tools/ca2/number_in.h"
#include "tools/ca2/packet_report.h"

namespace ca2 {
namespace {

using nlohmann::json;

struct Options {
  std::vector<std::uint16_t> ports;  // empty: the vendors' defaults, or a capture's all
  double duration = 3;               // s
  std::filesystem::path pcap;
  std::string group, interface;
  std::vector<std::string> probe_hosts;  // empty: those heard
  bool share = false, probe = false, as_json = false;
  bool only_cameras = false, controls = false;
};

const std::vector<std::uint16_t> default_ports{7502, 7503, 2368, 8308};

/// What a listening gave.
struct Heard {
  Survey survey;
  PacketCounters counters;
  std::vector<std::string> warnings;
};

Result<void> read_all(PacketSource& source, std::chrono::steady_clock::time_point end, Heard& heard) {
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - std::chrono::steady_clock::now());
    const Result<PacketBatch> batch = source.next_batch(std::max(left, std::chrono::milliseconds(0)));
    heard.counters = source.counters();
    if (!batch) return fail(batch.error());
    for (const Datagram& datagram : batch->datagrams) heard.survey.add(datagram);
    const bool over = batch->event == PacketEvent::end || batch->event == PacketEvent::stopped;
    if (over || std::chrono::steady_clock::now() >= end) return {};
  }
}

Result<void> listen(const Options& options, Heard& heard) {
  UdpSourceOptions source_options;
  source_options.socket.multicast_group = options.group;
  source_options.socket.interface = options.interface;
  source_options.socket.share_port = options.share;
  std::vector<Problem> taken;
  for (const std::uint16_t port : options.ports.empty() ? default_ports : options.ports) {
    // A port that another program has is no reason not to listen to the others.
    UdpSocketOptions one = source_options.socket;
    one.port = port;
    if (const Result<UdpSocket> socket = open_udp_socket(one)) {
      source_options.ports.push_back(port);
    } else {
      taken.insert(taken.end(), socket.error().problems.begin(), socket.error().problems.end());
    }
  }
  if (source_options.ports.empty()) return fail(ErrorCode::unavailable, std::move(taken));
  for (const Problem& problem : taken) {
    heard.warnings.push_back(Error(ErrorCode::unavailable, problem.where, problem.what, problem.hint).text());
  }
  const auto source = UdpSource::open(source_options);
  if (!source) return fail(source.error());
  if (!(*source)->sockets()[0].warning.empty()) heard.warnings.push_back((*source)->sockets()[0].warning);
  const Interrupt interrupt(source->get());
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::nanoseconds>(
                                                          std::chrono::duration<double>(options.duration));
  return read_all(**source, end, heard);
}

Result<void> read_capture(const Options& options, Heard& heard) {
  PcapOptions pcap;
  pcap.ports = options.ports;
  const auto reader = PcapReader::open(options.pcap, pcap);
  if (!reader) return fail(reader.error());
  const Result<void> read = read_all(**reader, std::chrono::steady_clock::time_point::max(), heard);
  if (const auto cut = cut_packets(options.pcap.string(), heard.counters)) {
    heard.warnings.push_back(Error(ErrorCode::data, cut->where, "warning: " + cut->what, cut->hint).text());
  }
  return read;
}

/// What the sensor at an address says over HTTP. Reads only.
json probe(const std::string& address, const std::string& vendor) {
  const Result<ConfigurableSensor> sensor = connect_sensor(address, vendor);
  const Result<std::string> text = sensor ? sensor->read_identity() : fail(sensor.error());
  if (!text) return {{"error", text.error().text()}};
  json found = json::parse(*text);
  found["vendor"] = sensor->vendor();
  return found;
}

/// By address: the ones given, else those heard.
json probe_all(const Options& options, const Survey& survey) {
  json found = json::object();
  for (const std::string& address : options.probe_hosts) found[address] = probe(address, "auto");
  if (!options.probe_hosts.empty()) return found;
  std::set<std::pair<std::string, std::string>> hosts;
  for (const StreamSummary& stream : survey.streams()) {
    if (!stream.identity.vendor.empty()) hosts.insert({stream.source_address, stream.identity.vendor});
  }
  for (const auto& [host, vendor] : hosts)
    found[host] = probe(host, vendor == "Ouster" ? "ouster" : "velodyne");
  return found;
}

json streams_json(const Survey& survey) {
  json list = json::array();
  for (const StreamSummary& stream : survey.streams()) {
    json details = json::object();
    for (const auto& [key, value] : stream.identity.details) details[key] = value;
    json entry = {{"source", stream.source_address},
                  {"port", stream.destination_port},
                  {"size", stream.size},
                  {"cut", stream.cut},
                  {"datagrams", stream.datagrams},
                  {"rate_hz", stream.rate()},
                  {"vendor", stream.identity.vendor},
                  {"model", stream.identity.model},
                  {"kind", stream.identity.kind},
                  {"details", details}};
    entry["lost"] = stream.identity.lost ? json(*stream.identity.lost) : json();
    list.push_back(std::move(entry));
  }
  return list;
}

void print_streams(const Survey& survey, const json& probed) {
  for (const StreamSummary& stream : survey.streams()) {
    const StreamIdentity& identity = stream.identity;
    const std::string who =
        stream.cut ? "cut short by its recording: whose they are cannot be told"
        : identity.vendor.empty()
            ? "not a LiDAR known here"
            : identity.vendor + " " + (identity.model.empty() ? "" : identity.model + " ") + identity.kind;
    std::printf("%s -> port %u: %s\n", stream.source_address.c_str(), stream.destination_port, who.c_str());
    std::printf("    %s, %.1f/s, %s", counted(stream.size, "byte").c_str(), stream.rate(),
                counted(stream.datagrams, "datagram").c_str());
    if (identity.lost) std::printf(", %llu lost", static_cast<unsigned long long>(*identity.lost));
    std::printf("\n");
    for (const auto& [key, value] : identity.details) std::printf("    %s: %s\n", key.c_str(), value.c_str());
  }
  if (survey.unlisted() > 0) {
    std::printf("and %s of further streams\n", counted(survey.unlisted(), "datagram").c_str());
  }
  for (const auto& [host, value] : probed.items())
    std::printf("%s says: %s\n", host.c_str(), value.dump(2).c_str());
}

/// Only asks: nothing is listened to.
Result<int> ask(const Options& options) {
  const json probed = probe_all(options, {});
  if (options.as_json) {
    std::printf("%s\n", json{{"probe", probed}}.dump(2, ' ', false, json::error_handler_t::replace).c_str());
  } else {
    print_streams({}, probed);
  }
  const auto silent = [](const json& answer) { return answer.contains("error"); };
  if (std::none_of(probed.begin(), probed.end(), silent)) return 0;
  return fail(ErrorCode::unavailable, "", "not every sensor answered");
}

/// Looking for cameras takes a second, and goes on while LiDARs are listened to.
json find_cameras(const Options& options, std::vector<std::string>& warnings) {
  if (!options.pcap.empty() || !options.ports.empty()) return json::array();
  const CameraListing listing = list_cameras();
  for (const Problem& problem : listing.problems) {
    warnings.push_back(Error(ErrorCode::unavailable, problem.where, problem.what, problem.hint).text());
  }
  return cameras_json(listing, options.controls);
}

Result<int> run(const Options& options) {
  if (!options.probe_hosts.empty()) return ask(options);
  Heard heard;
  std::vector<std::string> camera_warnings;
  auto looking = std::async(std::launch::async, [&] { return find_cameras(options, camera_warnings); });
  Result<void> done;
  if (!options.pcap.empty()) {
    done = read_capture(options, heard);
  } else if (!options.only_cameras) {
    done = listen(options, heard);
  }
  const json cameras = looking.get();
  heard.warnings.insert(heard.warnings.end(), camera_warnings.begin(), camera_warnings.end());
  const bool nothing = heard.survey.streams().empty() && cameras.empty();
  if (!done && nothing) return fail(done.error());
  const json probed =
      options.probe && options.pcap.empty() ? probe_all(options, heard.survey) : json::object();
  if (options.as_json) {
    json report = {{"cameras", cameras},
                   {"streams", streams_json(heard.survey)},
                   {"counters", counters_json(heard.counters)},
                   {"warnings", heard.warnings}};
    if (options.probe) report["probe"] = probed;
    std::printf("%s\n", report.dump(2, ' ', false, json::error_handler_t::replace).c_str());
  } else {
    for (const std::string& warning : heard.warnings) std::fprintf(stderr, "ca2: %s\n", warning.c_str());
    print_cameras(cameras);
    print_streams(heard.survey, probed);
    if (heard.counters.lost() > 0) print_counters(stdout, heard.counters);
  }
  if (!done) return fail(done.error());
  if (nothing && !options.pcap.empty()) {
    return fail(ErrorCode::data, options.pcap.string(), "has no datagrams",
                "without `--port`, those to all ports count");
  }
  if (nothing) {
    return fail(ErrorCode::unavailable, options.pcap.string(),
                options.only_cameras ? "there is no camera" : "no camera is there and nothing was heard",
                options.only_cameras
                    ? "is it plugged in and powered?"
                    : "is the sensor on, and does it send to this host and these ports? (`--port`)");
  }
  return 0;
}

}  // namespace

CommandBody setup_sensors(CLI::App& app) {
  auto options = std::make_shared<Options>();
  app.add_option("--port", options->ports, "Only LiDARs, on these UDP ports; default 7502 7503 2368 8308")
      ->check(number_in(1, 65535));
  app.add_option("--duration", options->duration, "Seconds to listen")
      ->capture_default_str()
      ->check(seconds());
  app.add_option("--pcap", options->pcap, "Look into this capture file instead");
  app.add_option("--group", options->group, "Multicast group to join");
  app.add_option("--interface", options->interface, "Interface for the group");
  app.add_flag("--share", options->share,
               "Share the ports with programs that share them too; takes their unicast packets");
  const CLI::Option* probe =
      app.add_option(
             "--probe", options->probe_hosts,
             "Ask the sensors heard about themselves over HTTP (reads only); with HOST or HOST:PORT,\n"
             "ask these and do not listen")
          ->expected(0, -1);
  app.add_flag("--cameras", options->only_cameras, "Only cameras: does not listen");
  app.add_flag("--controls", options->controls, "Open each camera and print what can be set");
  app.add_flag("--json", options->as_json, "For programs");
  return [options, probe] {
    options->probe = probe->count() > 0;
    std::erase(options->probe_hosts, "");
    return run(*options);
  };
}

}  // namespace ca2
