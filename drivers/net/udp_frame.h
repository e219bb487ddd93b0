/// @file Ethernet, IP and UDP headers for a payload that arrived without them.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "drivers/net/ip_address.h"

namespace ca2 {

/// The most a UDP datagram can carry over IPv4; over IPv6 it is 20 bytes more.
constexpr std::size_t largest_payload_v4 = 65507;
constexpr std::size_t largest_payload_v6 = 65527;

struct UdpEndpoints {
  IpAddress source, destination;  ///< of one family
  std::uint16_t source_port = 0, destination_port = 0;
};

/// Headers in front of a payload; `bytes` holds Ethernet + IPv6 + UDP, IPv4 uses 42 of the 62 bytes.
struct UdpFrameHeaders {
  std::array<std::uint8_t, 62> bytes{};
  std::size_t size = 0;
};

/// Headers with right lengths and checksums. `missing`: bytes the payload lost (they count in the lengths;
/// the UDP checksum is then 0 for "none" over IPv4, and cannot be right over IPv6). The frame is one piece
/// however long: Ouster's own recordings are like that, and the vendors' tools read frames longer than an
/// Ethernet's as well as fragments, but one record per datagram keeps its time exact. MAC addresses are
/// locally administered ones made of the IP address, or the ones broadcast and multicast addresses stand for.
/// `id` is the IPv4 identification.
UdpFrameHeaders udp_frame_headers(const UdpEndpoints& ends, std::span<const std::uint8_t> payload,
                                  std::size_t missing, std::uint16_t id);

/// RFC 1071 over `bytes`, on top of `sum` (host order, not yet folded).
std::uint64_t checksum_add(std::uint64_t sum, std::span<const std::uint8_t> bytes);
std::uint16_t checksum_fold(std::uint64_t sum);

}  // namespace ca2
