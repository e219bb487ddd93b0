/// @file Where datagrams come from: a socket or a capture file, behind one interface.
#pragma once

#include <chrono>
#include <span>

#include "core/types/result.h"
#include "drivers/net/datagram.h"
#include "drivers/net/packet_counters.h"

namespace ca2 {

/// Why PacketSource::next_batch came back.
enum class PacketEvent {
  packets,  ///< there are datagrams
  timeout,  ///< nothing came in time (sockets only); ask again
  stopped,  ///< stop() was called (sockets only); stays so
  end,      ///< the file has no more; stays so
};

struct PacketBatch {
  PacketEvent event = PacketEvent::timeout;
  std::span<const Datagram> datagrams;  ///< in the order of arrival; empty unless event is packets
};

/// A stream of datagrams. One thread reads it.
class PacketSource {
 public:
  PacketSource() = default;
  PacketSource(const PacketSource&) = delete;
  PacketSource& operator=(const PacketSource&) = delete;
  virtual ~PacketSource() = default;

  /// The next datagrams, as many as are at hand and fit a batch; they are valid until the next call.
  /// A socket waits for the first one up to `timeout`; a file never waits (pacing is its reader's business).
  /// Errors: `io` when the socket fails, `data` when the file is damaged. What came before an error has been
  /// delivered by the call before.
  virtual Result<PacketBatch> next_batch(std::chrono::milliseconds timeout) = 0;

  virtual const PacketCounters& counters() const = 0;
};

}  // namespace ca2
