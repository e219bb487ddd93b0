/// @file `ca2 play`: a capture's datagrams, sent again.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <thread>

#include "drivers/camera/host_time.h"
#include "drivers/net/pacer.h"
#include "drivers/net/pcap_reader.h"
#include "drivers/net/udp_sender.h"
#include "tools/ca2/command.h"
#include "tools/ca2/host_port.h"
#include "tools/ca2/interrupt.h"
#include "tools/ca2/number_in.h"
#include "tools/ca2/packet_report.h"

namespace ca2 {
namespace {

struct Options {
  std::filesystem::path file;
  std::string to;
  double speed = 1;
  std::optional<std::int64_t> shift;  ///< ns
  PcapOptions pcap;
  bool as_json = false;
};

std::int64_t steady_now() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

Result<int> run(const Options& options) {
  const Result<HostPort> destination = parse_host_port(options.to);
  if (!destination) return fail(destination.error());
  const auto reader = PcapReader::open(options.file, options.pcap);
  if (!reader) return fail(reader.error());
  auto sender = UdpSender::open(destination->host);
  if (!sender) return fail(sender.error());

  const Interrupt interrupt;
  Pacer pacer(options.speed);
  if (options.shift) pacer.wait(utc_now() - *options.shift, steady_now());
  std::uint64_t sent = 0;
  while (!Interrupt::raised()) {
    const Result<PacketBatch> batch = (*reader)->next_batch();
    if (!batch) return fail(batch.error());
    if (batch->event == PacketEvent::end) break;
    for (const Datagram& datagram : batch->datagrams) {
      if (Interrupt::raised()) break;
      // In steps, so that Ctrl-C does not have to wait for a long gap's end.
      while (const std::int64_t wait = pacer.wait(datagram.time, steady_now())) {
        if (Interrupt::raised()) break;
        std::this_thread::sleep_for(std::chrono::nanoseconds(std::min<std::int64_t>(wait, 100'000'000)));
      }
      const std::uint16_t port = destination->port != 0 ? destination->port : datagram.destination_port;
      if (auto done = sender->send(port, datagram.payload); !done) return fail(done.error());
      ++sent;
    }
  }
  const PacketCounters& counters = (*reader)->counters();
  if (options.as_json) {
    const nlohmann::json report = {{"sent", sent}, {"counters", counters_json(counters)}};
    std::printf("%s\n", report.dump(2).c_str());
  } else {
    std::printf("%14llu  datagrams sent\n", static_cast<unsigned long long>(sent));
    if (counters.lost() > 0) print_counters(stdout, counters);
  }
  return 0;
}

}  // namespace

CommandBody setup_play(CLI::App& app) {
  auto options = std::make_shared<Options>();
  app.add_option("file", options->file, "Capture file")->required();
  app.add_option("--to", options->to, "HOST or HOST:PORT; without a port, each datagram's own")->required();
  app.add_option("--speed", options->speed, "1: as recorded; 0: as fast as possible")
      ->capture_default_str()
      ->check(number_in(0, 1000));
  app.add_option("--shift", options->shift,
                 "ns from a datagram's recorded time to the host's time at which it is sent, so that several "
                 "players keep together (default: the first one is sent at once)")
      ->check(number_in(-4e18, 4e18));
  app.add_option("--port", options->pcap.ports, "Only datagrams that were sent to these ports")
      ->check(number_in(1, 65535));
  app.add_option("--source", options->pcap.sources, "Only datagrams from these addresses");
  app.add_flag("--json", options->as_json, "Report for programs");
  return [options] { return run(*options); };
}

}  // namespace ca2
