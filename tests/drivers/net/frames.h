/// @file Packets and capture files made by hand, byte by byte, for the tests of the readers.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace ca2::test {

using Bytes = std::vector<std::uint8_t>;

Bytes operator+(Bytes left, const Bytes& right);
Bytes be16(unsigned value);
Bytes be32(std::uint32_t value);
/// `size` bytes of a pattern that tells offsets apart.
Bytes pattern(std::size_t size, unsigned seed = 0);

/// UDP header (checksum 0) and payload.
Bytes udp(unsigned source_port, unsigned destination_port, const Bytes& payload);

struct Ipv4Fields {
  std::string source = "192.0.2.7", destination = "192.0.2.1";
  unsigned id = 1, offset = 0;  ///< offset in bytes
  bool more = false;
  unsigned protocol = 17;
  int length = -1;  ///< total length; -1: the right one
};
Bytes ipv4(const Ipv4Fields& fields, const Bytes& payload);
Bytes ipv6(const std::string& source, const std::string& destination, unsigned next_header,
           const Bytes& payload);
/// The fragment extension header of IPv6 in front of `payload`.
Bytes ipv6_fragment(unsigned next_header, unsigned offset, bool more, std::uint32_t id, const Bytes& payload);
Bytes ethernet(unsigned ethertype, const Bytes& payload);

struct Record {
  std::uint32_t seconds = 0, fraction = 0;
  Bytes frame;
  int wire_size = -1;  ///< -1: as captured
};
/// A capture file; `magic` chooses the resolution: 0xa1b2c3d4 us, 0xa1b23c4d ns.
Bytes pcap(std::uint32_t link_type, const std::vector<Record>& records, std::uint32_t magic = 0xa1b2c3d4,
           bool big_endian = false);

/// The payload cut into IPv4 fragments of `piece` bytes (a multiple of 8).
std::vector<Bytes> ipv4_fragments(Ipv4Fields fields, const Bytes& payload, std::size_t piece);

}  // namespace ca2::test
