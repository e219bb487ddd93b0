/// @file `ca2 bench ingest`: CPU per datagram received, against one recvmsg per datagram, in one run.
#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <vector>

#include "tools/ca2/bench.h"
#include "tools/ca2/ingest_cost.h"

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

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
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
  if (options.json) std::printf("%s\n", rows.dump(2).c_str());
  return 0;
}

}  // namespace ca2
