/// @file Capture files, frames and fragments of any content: nothing may crash, read outside its input, grow
/// without bound, or lose count.
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "drivers/net/pcap_reader.h"
#include "drivers/net/udp_dissector.h"

namespace {

using namespace ca2;

void require(bool condition) {
  if (!condition) std::abort();
}

/// Every record is delivered, refused for one reason, or part of a datagram.
void check(const PacketCounters& counters) {
  require(counters.records + counters.reassembled == counters.datagrams + counters.not_ip + counters.not_udp +
                                                         counters.bad_headers + counters.fragments);
  require(counters.fragments >=
          counters.reassembled + counters.fragments_repeated + counters.fragments_invalid);
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
      require(datagram.payload.size() <= content.size());
      ++datagrams;
    }
  }
  require(datagrams == (*reader)->counters().datagrams);
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
      require(found->datagram.payload.size() <= 65535);
    }
    input = input.subspan(4 + size);
  }
  dissector.finish();
  check(dissector.counters);
}

}  // namespace

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
