#include "tests/drivers/net/frames.h"

#include <algorithm>

#include "drivers/net/ip_address.h"

namespace ca2::test {

Bytes operator+(Bytes left, const Bytes& right) {
  left.insert(left.end(), right.begin(), right.end());
  return left;
}

Bytes be16(unsigned value) {
  return {static_cast<std::uint8_t>(value >> 8), static_cast<std::uint8_t>(value)};
}

Bytes be32(std::uint32_t value) {
  return be16(value >> 16) + be16(value & 0xffff);
}

Bytes pattern(std::size_t size, unsigned seed) {
  Bytes bytes(size);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::uint8_t>(i * 7 + i / 251 + seed * 31);
  return bytes;
}

Bytes udp(unsigned source_port, unsigned destination_port, const Bytes& payload) {
  return be16(source_port) + be16(destination_port) + be16(static_cast<unsigned>(payload.size() + 8)) +
         be16(0) + payload;
}

Bytes ipv4(const Ipv4Fields& fields, const Bytes& payload) {
  const IpAddress source = *parse_ip_address(fields.source),
                  destination = *parse_ip_address(fields.destination);
  const unsigned length =
      fields.length < 0 ? static_cast<unsigned>(payload.size() + 20) : static_cast<unsigned>(fields.length);
  return Bytes{0x45, 0} + be16(length) + be16(fields.id) +
         be16((fields.more ? 0x2000u : 0u) | fields.offset / 8) +
         Bytes{64, static_cast<std::uint8_t>(fields.protocol), 0, 0} +
         Bytes(source.bytes.begin(), source.bytes.begin() + 4) +
         Bytes(destination.bytes.begin(), destination.bytes.begin() + 4) + payload;
}

Bytes ipv6(const std::string& source, const std::string& destination, unsigned next_header,
           const Bytes& payload) {
  const IpAddress from = *parse_ip_address(source), to = *parse_ip_address(destination);
  return Bytes{0x60, 0, 0, 0} + be16(static_cast<unsigned>(payload.size())) +
         Bytes{static_cast<std::uint8_t>(next_header), 64} + Bytes(from.bytes.begin(), from.bytes.end()) +
         Bytes(to.bytes.begin(), to.bytes.end()) + payload;
}

Bytes ipv6_fragment(unsigned next_header, unsigned offset, bool more, std::uint32_t id,
                    const Bytes& payload) {
  return Bytes{static_cast<std::uint8_t>(next_header), 0} + be16(offset | (more ? 1u : 0u)) + be32(id) +
         payload;
}

Bytes ethernet(unsigned ethertype, const Bytes& payload) {
  return Bytes(12, 0) + be16(ethertype) + payload;
}

Bytes pcap(std::uint32_t link_type, const std::vector<Record>& records, std::uint32_t magic,
           bool big_endian) {
  const auto number = [&](std::uint32_t value) {
    Bytes bytes = be32(value);
    if (!big_endian) std::reverse(bytes.begin(), bytes.end());
    return bytes;
  };
  Bytes version = big_endian ? Bytes{0, 2, 0, 4} : Bytes{2, 0, 4, 0};
  Bytes file = number(magic) + version + number(0) + number(0) + number(262144) + number(link_type);
  for (const Record& record : records) {
    const auto size = static_cast<std::uint32_t>(record.frame.size());
    const std::uint32_t wire = record.wire_size < 0 ? size : static_cast<std::uint32_t>(record.wire_size);
    file = std::move(file) + number(record.seconds) + number(record.fraction) + number(size) + number(wire) +
           record.frame;
  }
  return file;
}

std::vector<Bytes> ipv4_fragments(Ipv4Fields fields, const Bytes& payload, std::size_t piece) {
  std::vector<Bytes> fragments;
  for (std::size_t at = 0; at < payload.size(); at += piece) {
    const std::size_t end = std::min(at + piece, payload.size());
    fields.offset = static_cast<unsigned>(at);
    fields.more = end < payload.size();
    fragments.push_back(ipv4(fields, Bytes(payload.begin() + static_cast<std::ptrdiff_t>(at),
                                           payload.begin() + static_cast<std::ptrdiff_t>(end))));
  }
  return fragments;
}

}  // namespace ca2::test
