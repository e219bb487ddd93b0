/// @file One socket's recvmmsg loop body.
#pragma once

#include <netinet/in.h>
#include <sys/socket.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "drivers/net/datagram.h"
#include "drivers/net/ip_address.h"
#include "drivers/net/packet_counters.h"
#include "drivers/net/udp_dissector.h"
#include "drivers/net/udp_socket.h"
#include "drivers/net/wrapping_counter.h"

namespace ca2 {

/// The buffers of a socket and what the kernel said of it so far.
class UdpReceiver {
 public:
  UdpReceiver(int fd, std::uint16_t port, std::size_t largest_payload);

  /// Appends what is there to `datagrams`, without waiting; they are valid until the next call. 0, or the
  /// errno of a socket that failed.
  int receive(const DatagramFilter& filter, std::vector<Datagram>& datagrams, PacketCounters& counters);

 private:
  struct Control {  // room for the kernel's two notes, aligned as CMSG_ wants it
    alignas(cmsghdr) unsigned char bytes[CMSG_SPACE(sizeof(timespec)) + CMSG_SPACE(sizeof(std::uint32_t))];
  };

  void read_notes(msghdr& header, Datagram& datagram, PacketCounters& counters);

  int fd_;
  std::uint16_t port_;
  std::size_t largest_;
  std::size_t stride_;                      ///< bytes from buffer to buffer
  std::unique_ptr<std::uint8_t[]> buffer_;  ///< not zeroed: pages are taken as datagrams need them
  std::vector<mmsghdr> messages_;
  std::vector<iovec> vectors_;
  std::vector<sockaddr_storage> senders_;
  std::vector<Control> controls_;
  std::vector<AddressText> texts_;
  WrappingCounter dropped_;
};

}  // namespace ca2
