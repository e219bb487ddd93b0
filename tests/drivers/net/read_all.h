/// @file Everything a packet source has, copied.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "drivers/net/packet_source.h"

namespace ca2::test {

struct KeptDatagram {
  std::int64_t time = 0;
  std::string source_address;
  std::uint16_t source_port = 0, destination_port = 0;
  std::vector<std::uint8_t> payload;
  bool truncated = false;

  bool operator==(const KeptDatagram&) const = default;
};

inline KeptDatagram keep(const Datagram& datagram) {
  return {datagram.time,
          std::string(datagram.source_address),
          datagram.source_port,
          datagram.destination_port,
          {datagram.payload.begin(), datagram.payload.end()},
          datagram.truncated};
}

/// Until the end, or an error (which goes to `error` if given, else fails the test).
inline std::vector<KeptDatagram> read_all(PacketSource& source, Error* error = nullptr) {
  std::vector<KeptDatagram> all;
  for (;;) {
    const Result<PacketBatch> batch = source.next_batch(std::chrono::milliseconds(0));
    if (!batch) {
      if (error == nullptr) {
        ADD_FAILURE() << batch.error().text();
      } else {
        *error = batch.error();
      }
      return all;
    }
    if (batch->event != PacketEvent::packets) return all;
    for (const Datagram& datagram : batch->datagrams) all.push_back(keep(datagram));
  }
}

}  // namespace ca2::test
