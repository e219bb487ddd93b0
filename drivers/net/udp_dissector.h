/// @file From a captured frame to the UDP datagram in it, with everything on the way counted.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/types/result.h"
#include "drivers/net/datagram.h"
#include "drivers/net/ip_reassembly.h"
#include "drivers/net/link_layer.h"

namespace ca2 {

/// Which datagrams are wanted. Empty lists: all.
struct DatagramFilter {
  std::vector<std::uint16_t> ports;  ///< destination ports
  std::vector<IpAddress> sources;

  bool wants_port(std::uint16_t port) const;
  bool wants_source(const IpAddress& source) const;
};

/// Reads the addresses of a filter; error `usage` where one is not numeric.
Result<std::vector<IpAddress>> parse_sources(const std::vector<std::string>& texts);

/// A datagram and the address it came from, as bytes (Datagram::source_address is not set).
struct DissectedDatagram {
  Datagram datagram;
  IpAddress source;
};

/// Frames of one link type in, datagrams out; keeps the fragments.
class UdpDissector {
 public:
  UdpDissector(LinkType link, DatagramFilter filter, ReassemblyLimits limits)
      : link_(link), filter_(std::move(filter)), reassembler_(limits) {}

  /// `frame`: what was captured of a frame that had `wire_size` bytes. The payload of the answer is valid
  /// until the next call, and no longer than `frame`.
  std::optional<DissectedDatagram> add(std::span<const std::uint8_t> frame, std::size_t wire_size,
                                       std::int64_t time);

  /// Call at the end: fragments without the rest are counted.
  void finish() { reassembler_.give_up(counters); }

  PacketCounters counters;

 private:
  LinkType link_;
  DatagramFilter filter_;
  IpReassembler reassembler_;
};

}  // namespace ca2
