/// @file UDP sockets as LiDARs need them: bound, stamped by the kernel, with a large receive buffer.
#pragma once

#include <netinet/in.h>

#include <cstdint>
#include <string>

#include "core/types/result.h"
#include "drivers/net/ip_address.h"
#include "drivers/net/unique_fd.h"

namespace ca2 {

struct UdpSocketOptions {
  std::uint16_t port = 0;       ///< 0: the system chooses
  std::string address;          ///< numeric local address; empty: any, IPv6 and IPv4
  std::string multicast_group;  ///< numeric; empty: none
  std::string interface;        ///< by name, for the group and for link-local addresses; empty: any
  bool share_port = false;      ///< let other programs that share too bind the same port: broadcast and
                                ///< multicast reach all of them, unicast only one
  std::size_t receive_buffer = 8u << 20;  ///< bytes asked of the kernel
};

/// A bound, non-blocking socket with SO_TIMESTAMPNS and SO_RXQ_OVFL on.
struct UdpSocket {
  UniqueFd fd;
  std::uint16_t port = 0;                ///< bound to
  bool v4 = false, v6 = false;           ///< families it receives
  std::size_t receive_buffer_asked = 0;  ///< bytes
  std::size_t receive_buffer = 0;        ///< bytes really granted
  std::string warning;                   ///< what the person should know, and do; empty: nothing
};

/// Errors: `usage` for addresses that are none, `unavailable` for a port in use, an unknown interface or
/// address, `no_permission`, `io`.
Result<UdpSocket> open_udp_socket(const UdpSocketOptions& options);

/// The address a kernel call filled in.
IpAddress address_of(const sockaddr_storage& storage);
std::uint16_t port_of(const sockaddr_storage& storage);

/// For the socket calls; `scope` is the interface index of a link-local IPv6 address.
socklen_t to_sockaddr(const IpAddress& address, std::uint16_t port, unsigned scope,
                      sockaddr_storage& storage);

}  // namespace ca2
