/// @file `ca2 bench ingest`: CPU per datagram received, against one recvmsg per datagram, in one run.
#include <cstdio>
#include <nlohmann/json.hpp>
#include <vector>

#include "tools/ca2/bench.h"
#include "tools/ca2/bench_timing.h"
#include "tools/ca2/ingest_cost.h"
#include "tools/ca2/ingest_sustained.h"

namespace ca2 {
namespace {

/// A stream to receive.
struct Stream {
  const char* name;
  std::size_t payload;  ///< bytes
  double rate;          ///< datagrams per second
};

constexpr Stream streams[] = {
    {"VLP-16", 1206, 754},
    {"VLS-128", 1206, 6254},
    {"OS0-128 1024x10 low rate", 8448, 640},
    {"OS0-128 1024x10 legacy", 24896, 640},
};

/// With the preamble, header, check sequence and gap of Ethernet, IPv4 and UDP.
double gigabit_rate(std::size_t payload) {
  return 1e9 / (8 * (38 + 20 + 8 + static_cast<double>(payload)));
}

Result<void> bench_sustained(const BenchOptions& options, nlohmann::json& rows) {
  struct Load {
    const char* name;
    SustainedStream stream;
  };
  constexpr std::size_t small = 1206, large = 24896;
  // The large ones: half a revolution of an OS0-128 at a time, ten times a second.
  const Load loads[] = {{"1 Gbit/s", {small, gigabit_rate(small), 8, options.seconds}},
                        {"1 Gbit/s in bursts of 64", {small, gigabit_rate(small), 64, options.seconds}},
                        {"bursts of 64 large ones", {large, 640, 64, options.seconds}}};
  if (!options.json) {
    std::printf("\nAt a steady rate for %.3g s, from another thread, into a buffer of 4 MB\n\n",
                options.seconds);
    std::printf("%-26s %7s | %9s %9s %6s %9s | of a core\n", "load", "bytes", "per s", "sent", "lost",
                "CPU ns");
  }
  for (const Load& load : loads) {
    const Result<SustainedIngest> got = measure_sustained(load.stream);
    if (!got) return fail(got.error());
    const double rate = static_cast<double>(got->sent) / got->seconds, core = got->cpu_ns * 1e-9 * rate;
    rows.push_back({{"stream", load.name},
                    {"payload_bytes", load.stream.payload},
                    {"datagrams_per_s", rate},
                    {"sent", got->sent},
                    {"lost", got->sent - got->received},
                    {"kernel_dropped", got->kernel_dropped},
                    {"receive_buffer", got->receive_buffer},
                    {"batched_ns", got->cpu_ns},
                    {"share_of_core", core}});
    if (!options.json) {
      std::printf("%-26s %7zu | %9.0f %9llu %6llu %9.0f | %8.3f %%\n", load.name, load.stream.payload, rate,
                  static_cast<unsigned long long>(got->sent),
                  static_cast<unsigned long long>(got->sent - got->received), got->cpu_ns, 100 * core);
    }
  }
  return {};
}

}  // namespace

Result<int> bench_ingest(const BenchOptions& options) {
  constexpr std::uint64_t datagrams = 10'000;  // of each repeat
  if (!options.json) {
    std::printf("CPU ns per datagram in the receiving thread (user and kernel), median of %d; loopback\n\n",
                options.repeats);
    std::printf("%-26s %7s | %7s %18s %6s | of a core\n", "stream", "bytes", "batched", "recvmsg one by one",
                "ratio");
  }
  nlohmann::json rows = nlohmann::json::array();
  for (const Stream& stream : streams) {
    std::vector<double> batched, one_by_one, ratios;
    for (int i = 0; i < options.repeats; ++i) {
      const Result<IngestCost> cost = measure_ingest(stream.payload, datagrams);
      if (!cost) return fail(cost.error());
      batched.push_back(cost->batched_ns);
      one_by_one.push_back(cost->one_by_one_ns);
      ratios.push_back(cost->batched_ns / cost->one_by_one_ns);
    }
    const double core = median(batched) * 1e-9 * stream.rate;
    rows.push_back({{"stream", stream.name},
                    {"payload_bytes", stream.payload},
                    {"batched_ns", median(batched)},
                    {"one_by_one_ns", median(one_by_one)},
                    {"ratio", median(ratios)},
                    {"share_of_core", core}});
    if (!options.json) {
      std::printf("%-26s %7zu | %7.0f %18.0f %6.2f | %8.3f %%\n", stream.name, stream.payload,
                  median(batched), median(one_by_one), median(ratios), 100 * core);
    }
  }
  if (auto sustained = bench_sustained(options, rows); !sustained) return fail(sustained.error());
  if (options.json) std::printf("%s\n", rows.dump(2).c_str());
  return 0;
}

}  // namespace ca2
