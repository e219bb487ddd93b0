/// @file Inputs that are streams of packets: two bytes of length, then the packet.
#pragma once

#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "drivers/lidar/packet_decoder.h"
#include "tests/fuzz/fuzz_target.h"

namespace ca2::fuzz {

inline void append_packet(std::string& text, const std::vector<std::uint8_t>& packet) {
  text += static_cast<char>(packet.size() & 0xFF);
  text += static_cast<char>(packet.size() >> 8);
  text.append(packet.begin(), packet.end());
}

/// Pushes a stream through a decoder and checks what comes out.
inline void decode_all(PacketDecoder& decoder, std::span<const std::uint8_t> stream) {
  LidarCounters counters;
  const LidarSink sink = [](LidarScan&& out) {
    const Scan& scan = out.scan;
    require(scan.ring.size() == scan.size() && scan.time.size() == scan.size() &&
                scan.range.size() == scan.size() && scan.column.size() == scan.size() &&
                scan.intensity.size() == scan.size() && out.exact.size() == scan.size(),
            "arrays of different lengths");
    for (std::size_t i = 0; i < scan.size(); ++i) {
      require(scan.points[i].allFinite() && std::isfinite(scan.range[i]), "a point at infinity");
      require(scan.ring[i] < scan.rings && scan.column[i] < static_cast<unsigned>(scan.columns),
              "off the grid");
    }
  };
  std::int64_t time = 1'700'000'000'000'000'000;
  while (stream.size() >= 2) {
    const std::size_t wanted = stream[0] + 256u * stream[1];
    const std::size_t size = std::min(wanted, stream.size() - 2);
    // In memory of its own, so that a byte read past the end is seen.
    const std::vector<std::uint8_t> bytes(stream.begin() + 2,
                                          stream.begin() + 2 + static_cast<std::ptrdiff_t>(size));
    Datagram datagram;
    datagram.time = time += 1'000'000;
    datagram.payload = bytes;
    decoder.push(datagram, counters, sink);
    stream = stream.subspan(2 + size);
  }
  decoder.flush(counters, sink);
}

}  // namespace ca2::fuzz
