#include "drivers/net/ip_packet.h"

#include "drivers/net/wire.h"

namespace ca2 {
namespace {

// IANA protocol numbers of the IPv6 extension headers that carry a next header and a length.
constexpr std::uint8_t hop_by_hop = 0, routing = 43, fragment_header = 44, authentication = 51, options = 60;

/// Cuts `bytes` to the length the IP header gives, or notes why that cannot be.
void fit_to_length(IpPacket& packet, std::span<const std::uint8_t>& bytes, std::size_t length,
                   std::size_t wire_size) {
  if (length <= bytes.size()) {
    bytes = bytes.first(length);  // what follows is Ethernet's padding
  } else if (wire_size > bytes.size()) {
    packet.cut = true;
    packet.length_mismatch = length > wire_size;
  } else {
    packet.length_mismatch = true;
  }
}

std::optional<IpPacket> parse_v4(std::span<const std::uint8_t> bytes, std::size_t wire_size) {
  if (bytes.size() < 20) return std::nullopt;
  const std::size_t header = static_cast<std::size_t>(bytes[0] & 0x0f) * 4;
  if (header < 20 || header > bytes.size()) return std::nullopt;
  IpPacket packet;
  // A length of 0 is what segmentation offload leaves in captures: the packet reaches to the frame's end.
  const std::size_t length = read_be16(bytes, 2);
  if (length != 0 && length < header) return std::nullopt;
  if (length != 0) {
    fit_to_length(packet, bytes, length, wire_size);
  } else {
    packet.cut = wire_size > bytes.size();
  }
  packet.source = IpAddress::v4_from(bytes.subspan<12, 4>());
  packet.destination = IpAddress::v4_from(bytes.subspan<16, 4>());
  packet.protocol = bytes[9];
  packet.payload = bytes.subspan(header);
  const std::uint16_t flags = read_be16(bytes, 6);
  packet.id = read_be16(bytes, 4);
  packet.offset = (flags & 0x1fffu) * 8u;
  packet.more = (flags & 0x2000) != 0;
  packet.fragment = packet.more || packet.offset != 0;
  return packet;
}

std::optional<IpPacket> parse_v6(std::span<const std::uint8_t> bytes, std::size_t wire_size) {
  if (bytes.size() < 40) return std::nullopt;
  IpPacket packet;
  const std::size_t length = read_be16(bytes, 4);  // 0: a jumbogram, up to the frame's end
  if (length != 0) {
    fit_to_length(packet, bytes, 40 + length, wire_size);
  } else {
    packet.cut = wire_size > bytes.size();
  }
  packet.source = IpAddress::v6_from(bytes.subspan<8, 16>());
  packet.destination = IpAddress::v6_from(bytes.subspan<24, 16>());
  packet.protocol = bytes[6];
  packet.payload = bytes.subspan(40);
  if (!skip_extension_headers(packet.protocol, packet.payload)) return std::nullopt;
  if (packet.protocol == fragment_header) {
    if (packet.payload.size() < 8) return std::nullopt;
    packet.protocol = packet.payload[0];
    const std::uint16_t flags = read_be16(packet.payload, 2);
    packet.offset = flags & 0xfff8u;
    packet.more = (flags & 1) != 0;
    packet.id = read_be32(packet.payload, 4);
    packet.payload = packet.payload.subspan(8);
    packet.fragment = packet.more || packet.offset != 0;  // else an "atomic" fragment: whole
    if (!packet.fragment && !skip_extension_headers(packet.protocol, packet.payload)) return std::nullopt;
  }
  return packet;
}

}  // namespace

bool skip_extension_headers(std::uint8_t& protocol, std::span<const std::uint8_t>& payload) {
  constexpr int most_headers = 8;  // a real packet has one or two
  for (int i = 0; i < most_headers; ++i) {
    if (protocol != hop_by_hop && protocol != routing && protocol != authentication && protocol != options) {
      return true;
    }
    if (payload.size() < 8) return false;
    // RFC 4302 counts the authentication header in words of 4 bytes, RFC 8200 the others in words of 8.
    const std::size_t size = protocol == authentication ? (payload[1] + 2u) * 4u : (payload[1] + 1u) * 8u;
    if (size > payload.size()) return false;
    protocol = payload[0];
    payload = payload.subspan(size);
  }
  return false;
}

std::optional<IpPacket> parse_ip(std::span<const std::uint8_t> bytes, std::size_t wire_size) {
  if (bytes.empty()) return std::nullopt;
  switch (bytes[0] >> 4) {
    case 4:
      return parse_v4(bytes, wire_size);
    case 6:
      return parse_v6(bytes, wire_size);
    default:
      return std::nullopt;
  }
}

std::optional<UdpPacket> parse_udp(std::span<const std::uint8_t> bytes, bool cut) {
  if (bytes.size() < 8) return std::nullopt;
  const std::size_t length = read_be16(bytes, 4);
  if (length != 0 && length < 8) return std::nullopt;
  UdpPacket packet;
  packet.source_port = read_be16(bytes, 0);
  packet.destination_port = read_be16(bytes, 2);
  if (length == 0) {  // a jumbogram's, or never filled in: all there is
    packet.payload = bytes.subspan(8);
    packet.cut = cut;
    packet.length_mismatch = true;
  } else if (length <= bytes.size()) {
    packet.payload = bytes.subspan(8, length - 8);
  } else {
    packet.payload = bytes.subspan(8);
    packet.cut = true;
    packet.length_mismatch = !cut;
  }
  return packet;
}

}  // namespace ca2
