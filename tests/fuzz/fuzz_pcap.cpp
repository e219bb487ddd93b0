/// @file Capture files, frames and fragments of any content: nothing may crash, read outside its input, grow
/// without bound, or lose count.
#include <algorithm>
#include <cstdint>
#include <vector>

#include "drivers/net/pcap_reader.h"
#include "drivers/net/udp_dissector.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

using namespace ca2;
using fuzz::require;

using Text = std::string;

Text be16(std::size_t value) {
  return {static_cast<char>(value >> 8), static_cast<char>(value)};
}

Text ipv4(std::size_t offset, bool more, const Text& payload) {
  return Text("\x45\0", 2) + be16(payload.size() + 20) + be16(1) + be16((more ? 0x2000 : 0) + offset / 8) +
         Text("\x40\x11\0\0", 4) + "12345678" + payload;
}

Text ipv6(char next_header, const Text& payload) {
  return Text("\x60\0\0\0", 4) + be16(payload.size()) + Text{next_header, 64} + Text(32, 'a') + payload;
}

/// A frame as read_frames takes it, no time after the last one.
Text framed(const Text& frame) {
  return Text{static_cast<char>(frame.size()), static_cast<char>(frame.size() >> 8), 0, 0} + frame;
}

/// A record of a little-endian capture file.
Text record(const Text& frame) {
  const Text size{static_cast<char>(frame.size()), static_cast<char>(frame.size() >> 8), 0, 0};
  return Text("\1\0\0\0\2\0\0\0", 8) + size + size + frame;
}

/// Every record is delivered, refused for one reason, or part of a datagram.
void check(const PacketCounters& counters) {
  require(counters.records + counters.reassembled == counters.datagrams + counters.not_ip + counters.not_udp +
                                                         counters.bad_headers + counters.fragments,
          "a record is not accounted for");
  require(counters.fragments >= counters.reassembled + counters.fragments_repeated +
                                    counters.fragments_invalid + counters.fragments_cut,
          "more fragments came out than went in");
}

/// Reads all of what a datagram points to, for the address sanitizer.
std::uint32_t touch(const Datagram& datagram) {
  std::uint32_t sum = datagram.truncated;
  for (const std::uint8_t byte : datagram.payload) sum += byte;
  for (const char letter : datagram.source_address) sum += static_cast<unsigned char>(letter);
  return sum;
}

void read_file(std::span<const std::uint8_t> content) {
  auto reader = PcapReader::open_memory(content, "input");
  if (!reader) return;
  std::uint64_t datagrams = 0;
  for (;;) {
    const auto batch = (*reader)->next_batch();
    if (!batch || batch->event == PacketEvent::end) break;
    for (const Datagram& datagram : batch->datagrams) {
      [[maybe_unused]] volatile std::uint32_t sum = touch(datagram);
      require(datagram.payload.size() <= content.size(), "a payload larger than the file");
      ++datagrams;
    }
  }
  require(datagrams == (*reader)->counters().datagrams, "datagrams are miscounted");
  check((*reader)->counters());
}

/// Frames, each behind a size, a gap in time and how much longer it was on the wire: reaches reassembly
/// without the fuzzer having to invent a file round it.
void read_frames(LinkType link, std::span<const std::uint8_t> input) {
  UdpDissector dissector(link, {}, {.datagrams = 8, .age = 2'000'000'000});
  std::int64_t time = 0;
  while (input.size() >= 4) {
    const std::size_t size = std::min<std::size_t>(input[0] | (input[1] & 0x0f) << 8, input.size() - 4);
    time += input[2] * std::int64_t{10'000'000};
    const std::size_t wire = size + input[3] / 16;
    // A copy of its own, so that reading past the frame's end is caught.
    const std::vector<std::uint8_t> frame(input.begin() + 4,
                                          input.begin() + 4 + static_cast<std::ptrdiff_t>(size));
    if (const auto found = dissector.add(frame, wire, time)) {
      [[maybe_unused]] volatile std::uint32_t sum = touch(found->datagram);
      require(found->datagram.payload.size() <= 65535, "a payload larger than a datagram");
    }
    input = input.subspan(4 + size);
  }
  dissector.finish();
  check(dissector.counters);
}

}  // namespace

std::vector<std::string> ca2::fuzz::seeds() {
  const Text udp = be16(5000) + be16(7502) + be16(24) + be16(0) + Text(16, 'x');
  const Text vlan = Text(12, '\0') + be16(0x88a8) + be16(1) + be16(0x8100) + be16(2) + be16(0x0800);
  const auto fragment6 = [&](std::size_t offset, bool more, const Text& payload) {
    return ipv6(44, Text("\x11\0", 2) + be16(offset | (more ? 1 : 0)) + "abcd" + payload);
  };
  const Text options = Text("\x3c\0\0\0\0\0\0\0\x11\0\0\0\0\0\0\0", 16);
  const Text header("\xd4\xc3\xb2\xa1\2\0\4\0\0\0\0\0\0\0\0\0\0\0\4\0\1\0\0\0", 24);
  const Text ethernet = Text(12, '\0') + be16(0x0800) + ipv4(0, false, udp);
  return {Text(1, '\0') + framed(ipv4(0, true, udp.substr(0, 8))) + framed(ipv4(16, false, udp.substr(16))) +
              framed(ipv4(8, true, udp.substr(8, 8))),
          Text(1, '\0') + framed(fragment6(8, false, udp.substr(8))) +
              framed(fragment6(0, true, udp.substr(0, 8))),
          Text(1, '\0') + framed(ipv6(0, options + udp)),
          Text(1, '\1') + framed(vlan + ipv4(0, false, udp)),
          Text(1, '\xff') + header + record(ethernet) + record(ethernet),
          Text(1, '\xff') + header + record(Text(12, '\0') + be16(0x0800) + ipv4(0, true, udp.substr(0, 8))) +
              record(Text(12, '\0') + be16(0x0800) + ipv4(8, false, udp.substr(8)))};
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  constexpr LinkType links[] = {LinkType::raw,       LinkType::ethernet,   LinkType::null, LinkType::loop,
                                LinkType::linux_sll, LinkType::linux_sll2, LinkType::ipv4, LinkType::ipv6};
  const std::span<const std::uint8_t> rest(data + 1, size - 1);
  if (data[0] < std::size(links)) {
    read_frames(links[data[0]], rest);
  } else {
    read_file(rest);
  }
  return 0;
}
