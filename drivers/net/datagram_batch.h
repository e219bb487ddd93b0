/// @file Datagrams that own what they point to, for sources that must keep several at a time.
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "drivers/net/datagram.h"
#include "drivers/net/ip_address.h"

namespace ca2 {

/// A batch of datagrams in one block of memory, reused from batch to batch.
class DatagramBatch {
 public:
  void clear();

  /// Copies the payload and the address in. `datagram.source_address` is ignored.
  void add(const Datagram& datagram, const IpAddress& source);

  std::size_t size() const { return datagrams_.size(); }
  std::size_t bytes() const { return payloads_.size(); }

  /// Valid until the next clear() or add().
  std::span<const Datagram> view();

 private:
  std::vector<std::uint8_t> payloads_;  ///< all payloads, end to end
  std::vector<std::size_t> offsets_;    ///< of each datagram's payload
  std::vector<std::size_t> sizes_;
  std::vector<Datagram> datagrams_;
  std::deque<AddressText> texts_;  ///< one per place in the batch: its text stays put, and rarely changes
};

}  // namespace ca2
