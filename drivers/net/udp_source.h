/// @file Datagrams from the network, live.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "drivers/net/packet_source.h"
#include "drivers/net/udp_socket.h"

namespace ca2 {

struct UdpSourceOptions {
  std::vector<std::uint16_t> ports;     ///< one socket each; 0: the system chooses
  std::vector<std::string> sources;     ///< numeric addresses to listen to; empty: all. Several sensors may
                                        ///< send to one port.
  UdpSocketOptions socket;              ///< for all sockets; its `port` is not used
  std::size_t largest_payload = 65535;  ///< bytes kept of a datagram; longer ones are marked truncated
};

/// Receives in batches, from several ports in the order of the kernel's time stamps. What the kernel had to
/// drop is in counters().kernel_dropped as soon as a later datagram of that socket is received.
class UdpSource : public PacketSource {
 public:
  /// Errors as open_udp_socket, and `usage` for sources that are no addresses.
  static Result<std::unique_ptr<UdpSource>> open(const UdpSourceOptions& options);
  ~UdpSource() override;

  Result<PacketBatch> next_batch(std::chrono::milliseconds timeout) override;
  const PacketCounters& counters() const override;

  /// Makes next_batch answer `stopped`, at once and from then on. Safe from any thread and from a signal
  /// handler.
  void stop() noexcept;

  /// The sockets, in the order of the ports asked for: ports really bound, buffers granted, warnings.
  const std::vector<UdpSocket>& sockets() const;

 private:
  struct State;
  explicit UdpSource(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace ca2
