/// @file IP fragments back into datagrams: Ouster's packets of 3 to 33 kB are fragmented on an Ethernet of
/// 1500 bytes, and a capture file shows the fragments.
#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "drivers/net/ip_packet.h"
#include "drivers/net/packet_counters.h"

namespace ca2 {

/// Bounded in memory: `datagrams` times 64 kB.
struct ReassemblyLimits {
  std::size_t datagrams = 64;        ///< incomplete at a time; the oldest gives way
  std::int64_t age = 2'000'000'000;  ///< ns of capture time; a sensor's fragments come within ms,
                                     ///< and a 16-bit id comes round again after a minute or two
};

/// Fragments in any order and of several datagrams mixed. Fragments that overlap and disagree make the
/// datagram be given up (as RFC 5722 asks: nothing honest sends them); exact repetitions are ignored.
class IpReassembler {
 public:
  explicit IpReassembler(ReassemblyLimits limits = {}) : limits_(limits) {}

  /// Takes a fragment that was captured at `time` (ns). If it completes its datagram, the payload with
  /// everything else as in the fragment; it is valid until the next call. Counts in `counters`.
  std::optional<IpPacket> add(const IpPacket& fragment, std::int64_t time, PacketCounters& counters);

  /// Gives up what is incomplete, at the end of a file.
  void give_up(PacketCounters& counters);

  std::size_t pending() const { return pending_.size(); }

 private:
  struct Key {
    IpAddress source, destination;
    std::uint32_t id = 0;
    std::uint8_t protocol = 0;
    auto operator<=>(const Key&) const = default;
  };
  struct Range {
    std::uint32_t begin = 0, end = 0;
  };
  struct Pending {
    Key key;
    std::int64_t time = 0;
    std::uint32_t total = 0;    ///< bytes; 0 while the last fragment is missing
    std::vector<Range> ranges;  ///< what is there; sorted, apart from each other
    std::vector<std::uint8_t> bytes;
  };
  enum class Fit { fresh, repeated, overlapping };

  static Fit fit_of(const Pending& datagram, const IpPacket& fragment, Range range);
  static void insert(Pending& datagram, const IpPacket& fragment, Range range);
  void expire(std::int64_t now, PacketCounters& counters);
  Pending& open(const Key& key, std::int64_t time, PacketCounters& counters);
  void close(std::size_t index);

  ReassemblyLimits limits_;
  std::vector<Pending> pending_;  ///< oldest first
  std::vector<std::vector<std::uint8_t>> spare_;
  std::vector<std::uint8_t> done_;
};

}  // namespace ca2
