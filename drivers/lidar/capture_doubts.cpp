#include "drivers/lidar/capture_doubts.h"

#include "core/types/counted.h"

namespace ca2 {
namespace {

/// "603 dropped: serial number or model of another sensor", of the reason that took most; empty: none did.
std::string dropped_most(const LidarCounters& counters) {
  const LidarCounterInfo* most = nullptr;
  for (const LidarCounterInfo& info : lidar_counter_table()) {
    if (!info.help.starts_with("dropped: ") || counters.*info.value == 0) continue;
    if (!most || counters.*info.value > counters.*most->value) most = &info;
  }
  return most ? std::to_string(counters.*most->value) + " " + std::string(most->help) : std::string();
}

}  // namespace

std::optional<Problem> cut_packets(const std::string& file, const PacketCounters& packets) {
  const std::uint64_t cut = packets.cut_short + packets.fragments_cut;
  if (cut == 0) return std::nullopt;
  return Problem{file, "of " + counted(cut, "packet") + " only the beginning was recorded",
                 "`ca2 record packets` records whole ones, and so does `tcpdump -s 0`"};
}

std::vector<Problem> capture_doubts(const std::string& file, const LidarDriver& driver,
                                    const PacketCounters& packets) {
  std::vector<Problem> doubts;
  const LidarCounters& counters = driver.counters();
  if (auto cut = cut_packets(file, packets)) doubts.push_back(std::move(*cut));
  if (packets.cut_records > 0) {
    doubts.push_back({file,
                      "ends in the middle of a record: the recorder was killed, or the copy is not whole",
                      "what is before was read"});
  }
  if (counters.frames == 0) {
    const std::string reason = dropped_most(counters);
    doubts.push_back(
        {file,
         "no scan of this sensor, " + driver.model() + ", is in it" + (reason.empty() ? "" : ": " + reason),
         "`ca2 sensors --pcap " + file + "` names what is"});
  } else if (driver.found_source() && counters.other_source > 0) {
    doubts.push_back(
        {file,
         "has packets of several addresses, and only those of " + driver.source_address() + " were read",
         "`ca2 sensors --pcap " + file + "` lists them"});
  }
  return doubts;
}

}  // namespace ca2
