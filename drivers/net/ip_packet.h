/// @file IP and UDP headers, read without trusting them.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "drivers/net/ip_address.h"

namespace ca2 {

constexpr std::uint8_t protocol_udp = 17;

/// One IP packet, whole or a fragment; `payload` points into the frame.
struct IpPacket {
  IpAddress source;
  IpAddress destination;
  std::uint8_t protocol = 0;              ///< of the payload, after extension headers
  std::span<const std::uint8_t> payload;  ///< what is left of it in the frame
  bool cut = false;              ///< the capture length cut bytes off that the header says were there
  bool length_mismatch = false;  ///< the header promises more than was on the wire

  bool fragment = false;
  std::uint32_t id = 0;      ///< of the datagram the fragment belongs to
  std::uint32_t offset = 0;  ///< of the fragment's payload in the datagram's, bytes
  bool more = false;         ///< further fragments follow
};

/// `bytes`: what was captured from the IP header on; `wire_size`: what was on the wire (>= bytes.size()).
/// Nothing if the headers are damaged. Where the header's length exceeds what was on the wire (real captures
/// do that: offloading, and tools that invent headers) the bytes on the wire are taken.
std::optional<IpPacket> parse_ip(std::span<const std::uint8_t> bytes, std::size_t wire_size);

/// Skips IPv6 extension headers in front of a payload. False if they are damaged.
bool skip_extension_headers(std::uint8_t& protocol, std::span<const std::uint8_t>& payload);

struct UdpPacket {
  std::uint16_t source_port = 0;
  std::uint16_t destination_port = 0;
  std::span<const std::uint8_t> payload;
  bool cut = false;              ///< shorter than the header says
  bool length_mismatch = false;  ///< and not because of the capture length
};

/// `cut`: the IP packet's tail was not captured. Nothing if the header is damaged.
std::optional<UdpPacket> parse_udp(std::span<const std::uint8_t> bytes, bool cut);

}  // namespace ca2
