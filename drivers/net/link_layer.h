/// @file The link-layer headers of capture files: what precedes the IP packet in a frame.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

namespace ca2 {

/// Link types of capture files, as in the registry at tcpdump.org/linktypes.html; the values are libpcap's
/// DLT_ numbers on Linux, where LINKTYPE_RAW (101) is read as 12.
enum class LinkType {
  null = 0,         ///< BSD loopback: address family in the writer's byte order
  ethernet = 1,     ///< with any VLAN tags
  raw = 12,         ///< the IP packet itself
  loop = 108,       ///< OpenBSD loopback: address family in network byte order
  linux_sll = 113,  ///< Linux cooked capture ("any" device)
  ipv4 = 228,
  ipv6 = 229,
  linux_sll2 = 276,
};

/// The link type of a DLT_ number, if it is one we read.
std::optional<LinkType> link_type_from(int number);

enum class FrameKind { ip, other_protocol, damaged };

struct IpFrame {
  FrameKind kind = FrameKind::damaged;
  std::size_t offset = 0;  ///< where the IP packet starts, when kind is ip
};

/// Where the IP packet in a frame begins.
IpFrame find_ip(LinkType type, std::span<const std::uint8_t> frame);

}  // namespace ca2
