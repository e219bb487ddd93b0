/// @file Datagrams received at a steady rate, as from a wire that is full.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/types/result.h"

namespace ca2 {

struct SustainedStream {
  std::size_t payload = 1206;  ///< bytes
  double rate = 0;             ///< datagrams per second
  int burst = 1;               ///< sent in one go
  double seconds = 3;
  std::size_t receive_buffer = 4u << 20;  ///< bytes asked of the kernel
};

struct SustainedIngest {
  std::uint64_t sent = 0, received = 0;
  std::uint64_t kernel_dropped = 0;  ///< as the socket counts them
  std::size_t receive_buffer = 0;    ///< bytes granted
  double seconds = 0;                ///< that the sending really took
  double cpu_ns = 0;                 ///< of the receiving thread, user and kernel, per datagram received
};

/// A thread sends over the loopback, this one receives with UdpSource. A datagram has its number, so that
/// what is lost is not made up for by what comes twice. Errors: the sockets'.
Result<SustainedIngest> measure_sustained(const SustainedStream& stream);

}  // namespace ca2
