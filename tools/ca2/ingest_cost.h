/// @file What it costs to receive a LiDAR's datagrams.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/types/result.h"

namespace ca2 {

/// CPU time of the receiving thread, user and kernel, per datagram; the sending is not in it.
struct IngestCost {
  std::size_t payload = 0;      ///< bytes
  std::uint64_t datagrams = 0;  ///< measured
  double batched_ns = 0;        ///< UdpSource: recvmmsg, with kernel stamps, drop counter and addresses
  double one_by_one_ns = 0;     ///< recvmsg with the same notes, one call per datagram: the common way
};

/// Sends datagrams to itself over the loopback, the two ways by turns so that both see the same machine.
/// Errors: the sockets'.
Result<IngestCost> measure_ingest(std::size_t payload, std::uint64_t datagrams);

}  // namespace ca2
