#include "drivers/net/udp_dissector.h"

#include <algorithm>

namespace ca2 {

bool DatagramFilter::wants_port(std::uint16_t port) const {
  return ports.empty() || std::find(ports.begin(), ports.end(), port) != ports.end();
}

bool DatagramFilter::wants_source(const IpAddress& source) const {
  return sources.empty() || std::find(sources.begin(), sources.end(), source) != sources.end();
}

Result<std::vector<IpAddress>> parse_sources(const std::vector<std::string>& texts) {
  std::vector<IpAddress> sources;
  std::vector<Problem> problems;
  for (const std::string& text : texts) {
    if (const auto address = parse_ip_address(text)) {
      sources.push_back(*address);
    } else {
      problems.push_back(
          {"", "'" + text + "' is not a numeric IP address", "write it like 192.0.2.7 or fe80::1"});
    }
  }
  if (!problems.empty()) return fail(ErrorCode::usage, std::move(problems));
  return sources;
}

std::optional<DissectedDatagram> UdpDissector::add(std::span<const std::uint8_t> frame, std::size_t wire_size,
                                                   std::int64_t time) {
  ++counters.records;
  const IpFrame found = find_ip(link_, frame);
  if (found.kind != FrameKind::ip) {
    ++(found.kind == FrameKind::damaged ? counters.bad_headers : counters.not_ip);
    return std::nullopt;
  }
  std::optional<IpPacket> packet =
      parse_ip(frame.subspan(found.offset), std::max(wire_size, frame.size()) - found.offset);
  if (!packet) {
    ++counters.bad_headers;
    return std::nullopt;
  }
  if (!filter_.wants_source(packet->source)) {
    ++counters.other_source;
    return std::nullopt;
  }
  bool mismatch = packet->length_mismatch;
  if (packet->fragment) {
    packet = reassembler_.add(*packet, time, counters);
    if (!packet) return std::nullopt;
    if (!skip_extension_headers(packet->protocol, packet->payload)) {
      ++counters.bad_headers;
      return std::nullopt;
    }
  }
  if (packet->protocol != protocol_udp) {
    ++counters.not_udp;
    return std::nullopt;
  }
  const std::optional<UdpPacket> udp = parse_udp(packet->payload, packet->cut);
  if (!udp) {
    ++counters.bad_headers;
    return std::nullopt;
  }
  if (!filter_.wants_port(udp->destination_port)) {
    ++counters.other_port;
    return std::nullopt;
  }
  mismatch = mismatch || udp->length_mismatch;
  if (mismatch) ++counters.length_mismatches;
  if (udp->cut) ++counters.cut_short;
  ++counters.datagrams;
  counters.bytes += udp->payload.size();

  DissectedDatagram result;
  result.source = packet->source;
  result.datagram.time = time;
  result.datagram.source_port = udp->source_port;
  result.datagram.destination_port = udp->destination_port;
  result.datagram.payload = udp->payload;
  result.datagram.truncated = udp->cut;
  return result;
}

}  // namespace ca2
