#include "tools/ca2/packet_report.h"

#include <nlohmann/json.hpp>

namespace ca2 {

void print_counters(std::FILE* file, const PacketCounters& counters) {
  for_each_counter(counters, [&](const PacketCounterInfo& info, std::uint64_t value) {
    if (value > 0) std::fprintf(file, "%14llu  %s\n", static_cast<unsigned long long>(value), info.words);
  });
}

nlohmann::json counters_json(const PacketCounters& counters) {
  nlohmann::json json = nlohmann::json::object();
  for_each_counter(counters,
                   [&](const PacketCounterInfo& info, std::uint64_t value) { json[info.name] = value; });
  json["lost"] = counters.lost();
  return json;
}

}  // namespace ca2
