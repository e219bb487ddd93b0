#include "drivers/net/link_layer.h"

#include "drivers/net/wire.h"

namespace ca2 {
namespace {

constexpr std::uint16_t ethertype_ipv4 = 0x0800;
constexpr std::uint16_t ethertype_ipv6 = 0x86dd;

bool is_vlan_tag(std::uint16_t ethertype) {
  // IEEE 802.1Q, 802.1ad (QinQ), and the tag used for QinQ before it was standardised.
  return ethertype == 0x8100 || ethertype == 0x88a8 || ethertype == 0x9100;
}

/// Follows VLAN tags from an EtherType whose payload starts at `offset`.
IpFrame from_ethertype(std::uint16_t ethertype, std::span<const std::uint8_t> frame, std::size_t offset) {
  constexpr int most_tags = 4;
  for (int tags = 0; is_vlan_tag(ethertype); ++tags) {
    if (tags == most_tags || frame.size() < offset + 4) return {FrameKind::damaged, 0};
    ethertype = read_be16(frame, offset + 2);
    offset += 4;
  }
  if (ethertype != ethertype_ipv4 && ethertype != ethertype_ipv6) return {FrameKind::other_protocol, 0};
  return {FrameKind::ip, offset};
}

/// AF_INET is 2 everywhere; AF_INET6 is 10 on Linux, 24, 28 or 30 on the BSDs and macOS.
bool is_ip_family(std::uint32_t family) {
  return family == 2 || family == 10 || family == 24 || family == 28 || family == 30;
}

IpFrame from_loopback(std::span<const std::uint8_t> frame) {
  if (frame.size() < 4) return {FrameKind::damaged, 0};
  const std::uint32_t family = read_be32(frame, 0);
  // NULL has the byte order of the machine that captured: small numbers are taken in either order.
  const std::uint32_t swapped = __builtin_bswap32(family);
  if (!is_ip_family(family) && !is_ip_family(swapped)) return {FrameKind::other_protocol, 0};
  return {FrameKind::ip, 4};
}

}  // namespace

std::optional<LinkType> link_type_from(int number) {
  switch (static_cast<LinkType>(number)) {
    case LinkType::null:
    case LinkType::ethernet:
    case LinkType::raw:
    case LinkType::loop:
    case LinkType::linux_sll:
    case LinkType::ipv4:
    case LinkType::ipv6:
    case LinkType::linux_sll2:
      return static_cast<LinkType>(number);
  }
  return std::nullopt;
}

IpFrame find_ip(LinkType type, std::span<const std::uint8_t> frame) {
  const auto ethertype_at = [&](std::size_t at, std::size_t header) -> IpFrame {
    if (frame.size() < header) return {FrameKind::damaged, 0};
    return from_ethertype(read_be16(frame, at), frame, header);
  };
  switch (type) {
    case LinkType::ethernet:
      return ethertype_at(12, 14);
    case LinkType::linux_sll:
      return ethertype_at(14, 16);
    case LinkType::linux_sll2:
      return ethertype_at(0, 20);
    case LinkType::null:
    case LinkType::loop:
      return from_loopback(frame);
    case LinkType::raw:
    case LinkType::ipv4:
    case LinkType::ipv6:
      return {FrameKind::ip, 0};
  }
  return {FrameKind::damaged, 0};
}

}  // namespace ca2
