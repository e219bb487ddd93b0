/// @file What became of everything that came in from a socket or a capture file, by reason.
#pragma once

#include <cstdint>

namespace ca2 {

/// One number per line of packet_counters.def, all since the source was opened.
struct PacketCounters {
#define CA2_PACKET_COUNTER(name, kind, words) std::uint64_t name = 0;
#include "drivers/net/packet_counters.def"
#undef CA2_PACKET_COUNTER

  /// Everything that was not delivered: datagrams, records and fragments together.
  std::uint64_t lost() const;

  bool operator==(const PacketCounters&) const = default;
};

/// A line of the table, for printing.
struct PacketCounterInfo {
  const char* name;
  bool lost;          ///< counts something that was not delivered
  const char* words;  ///< for people
};

/// Calls `visit(const PacketCounterInfo&, std::uint64_t value)` for every counter, in the table's order.
template <class Visitor>
void for_each_counter(const PacketCounters& counters, Visitor&& visit) {
  enum Kind { note, lost };
#define CA2_PACKET_COUNTER(name, kind, words) \
  visit(PacketCounterInfo{#name, kind == lost, words}, counters.name);
#include "drivers/net/packet_counters.def"
#undef CA2_PACKET_COUNTER
}

inline std::uint64_t PacketCounters::lost() const {
  std::uint64_t sum = 0;
  for_each_counter(*this, [&](const PacketCounterInfo& info, std::uint64_t value) {
    if (info.lost) sum += value;
  });
  return sum;
}

}  // namespace ca2
