#include "drivers/net/udp_frame.h"

#include <algorithm>

#include "drivers/net/ip_packet.h"
#include "drivers/net/wire.h"

namespace ca2 {
namespace {

constexpr std::size_t ethernet_size = 14, ipv4_size = 20, ipv6_size = 40, udp_size = 8;
constexpr std::uint8_t time_to_live = 64;

using Mac = std::array<std::uint8_t, 6>;

Mac mac_of(const IpAddress& address) {
  const auto& b = address.bytes;
  if (address.v6) {
    if (address.multicast()) return {0x33, 0x33, b[12], b[13], b[14], b[15]};  // RFC 2464
    return {0x02, 0x00, b[12], b[13], b[14], b[15]};
  }
  if (b[0] == 255 && b[1] == 255 && b[2] == 255 && b[3] == 255) return {255, 255, 255, 255, 255, 255};
  if (address.multicast()) {  // RFC 1112
    return {0x01, 0x00, 0x5e, static_cast<std::uint8_t>(b[1] & 0x7f), b[2], b[3]};
  }
  return {0x02, 0x00, b[0], b[1], b[2], b[3]};
}

/// The UDP checksum, with the pseudo-header of either family.
std::uint16_t udp_checksum(const UdpEndpoints& ends, std::span<const std::uint8_t> header,
                           std::span<const std::uint8_t> payload) {
  const std::size_t address_size = ends.source.v6 ? 16 : 4;
  std::uint64_t sum = protocol_udp + udp_size + payload.size();
  sum = checksum_add(sum, std::span(ends.source.bytes).first(address_size));
  sum = checksum_add(sum, std::span(ends.destination.bytes).first(address_size));
  sum = checksum_add(sum, header);
  sum = checksum_add(sum, payload);
  const std::uint16_t checksum = checksum_fold(sum);
  return checksum == 0 ? 0xffff : checksum;  // 0 on the wire means "no checksum"
}

}  // namespace

std::uint64_t checksum_add(std::uint64_t sum, std::span<const std::uint8_t> bytes) {
  std::size_t i = 0;
  for (; i + 1 < bytes.size(); i += 2) sum += read_be16(bytes, i);
  if (i < bytes.size()) sum += static_cast<std::uint64_t>(bytes[i]) << 8;
  return sum;
}

std::uint16_t checksum_fold(std::uint64_t sum) {
  while (sum >> 16) sum = (sum & 0xffff) + (sum >> 16);
  return static_cast<std::uint16_t>(~sum);
}

UdpFrameHeaders udp_frame_headers(const UdpEndpoints& ends, std::span<const std::uint8_t> payload,
                                  std::size_t missing, std::uint16_t id) {
  const bool v6 = ends.source.v6;
  const std::size_t ip_size = v6 ? ipv6_size : ipv4_size;
  UdpFrameHeaders headers;
  headers.size = ethernet_size + ip_size + udp_size;
  const std::span<std::uint8_t> all(headers.bytes);

  const Mac to = mac_of(ends.destination), from = mac_of(ends.source);
  std::copy(to.begin(), to.end(), all.begin());
  std::copy(from.begin(), from.end(), all.begin() + 6);
  write_be16(all, 12, v6 ? 0x86dd : 0x0800);

  const auto udp_length = static_cast<std::uint16_t>(udp_size + payload.size() + missing);
  const std::span<std::uint8_t> ip = all.subspan(ethernet_size, ip_size);
  if (v6) {
    ip[0] = 0x60;
    write_be16(ip, 4, udp_length);
    ip[6] = protocol_udp;
    ip[7] = time_to_live;
    std::copy_n(ends.source.bytes.begin(), 16, ip.begin() + 8);
    std::copy_n(ends.destination.bytes.begin(), 16, ip.begin() + 24);
  } else {
    ip[0] = 0x45;
    write_be16(ip, 2, static_cast<std::uint16_t>(ipv4_size + udp_length));
    write_be16(ip, 4, id);
    ip[8] = time_to_live;
    ip[9] = protocol_udp;
    std::copy_n(ends.source.bytes.begin(), 4, ip.begin() + 12);
    std::copy_n(ends.destination.bytes.begin(), 4, ip.begin() + 16);
    write_be16(ip, 10, checksum_fold(checksum_add(0, ip)));
  }

  const std::span<std::uint8_t> udp = all.subspan(ethernet_size + ip_size, udp_size);
  write_be16(udp, 0, ends.source_port);
  write_be16(udp, 2, ends.destination_port);
  write_be16(udp, 4, udp_length);
  if (missing == 0) write_be16(udp, 6, udp_checksum(ends, udp, payload));
  return headers;
}

}  // namespace ca2
