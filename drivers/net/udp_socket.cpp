#include "drivers/net/udp_socket.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <net/if.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>

namespace ca2 {
namespace {

std::string describe(const UdpSocketOptions& options) {
  const std::string host = options.address.empty() ? "*" : options.address;
  return "UDP " + host + ":" + std::to_string(options.port);
}

tl::unexpected<Error> socket_error(const UdpSocketOptions& options, const std::string& doing) {
  const int code = errno;
  const std::string what = doing + ": " + std::strerror(code);
  switch (code) {
    case EADDRINUSE:
      return fail(ErrorCode::unavailable, describe(options), what,
                  "another program has this port (a running ca2d, or a vendor's viewer)");
    case EADDRNOTAVAIL:
    case ENODEV:
      return fail(ErrorCode::unavailable, describe(options), what,
                  "no interface here has this address; `ip address` shows them");
    case EACCES:
    case EPERM:
      return fail(ErrorCode::no_permission, describe(options), what, "ports below 1024 are the system's");
    default:
      return fail(ErrorCode::io, describe(options), what);
  }
}

bool set_flag(int fd, int level, int name, int value) {
  return ::setsockopt(fd, level, name, &value, sizeof value) == 0;
}

/// SO_RCVBUF is capped silently at net.core.rmem_max, and getsockopt answers with twice what was granted.
void size_receive_buffer(UdpSocket& socket, std::size_t asked) {
  (void)set_flag(socket.fd.get(), SOL_SOCKET, SO_RCVBUF, static_cast<int>(asked));
  int granted = 0;
  socklen_t length = sizeof granted;
  if (::getsockopt(socket.fd.get(), SOL_SOCKET, SO_RCVBUF, &granted, &length) != 0) granted = 0;
  socket.receive_buffer_asked = asked;
  socket.receive_buffer = static_cast<std::size_t>(granted) / 2;
  if (socket.receive_buffer < asked) {
    socket.warning = "the kernel granted a receive buffer of " +
                     std::to_string(socket.receive_buffer / 1024) + " KiB of the " +
                     std::to_string(asked / 1024) +
                     " KiB asked for; to raise it: sysctl -w net.core.rmem_max=" + std::to_string(asked);
  }
}

Result<void> join(const UdpSocketOptions& options, int fd, const IpAddress& group, unsigned scope) {
  if (!group.multicast()) {
    return fail(ErrorCode::usage, describe(options),
                "'" + options.multicast_group + "' is no multicast group",
                "groups are 224.0.0.0 to 239.255.255.255 and ff00::/8");
  }
  bool joined = false;
  if (group.v6) {
    ipv6_mreq request{};
    std::memcpy(&request.ipv6mr_multiaddr, group.bytes.data(), 16);
    request.ipv6mr_interface = scope;
    joined = ::setsockopt(fd, IPPROTO_IPV6, IPV6_ADD_MEMBERSHIP, &request, sizeof request) == 0;
    (void)set_flag(fd, IPPROTO_IPV6, IPV6_MULTICAST_ALL, 0);
  } else {
    ip_mreqn request{};
    std::memcpy(&request.imr_multiaddr, group.bytes.data(), 4);
    request.imr_ifindex = static_cast<int>(scope);
    joined = ::setsockopt(fd, IPPROTO_IP, IP_ADD_MEMBERSHIP, &request, sizeof request) == 0;
    // Else the socket also gets what other programs on this host joined.
    (void)set_flag(fd, IPPROTO_IP, IP_MULTICAST_ALL, 0);
  }
  if (!joined) return socket_error(options, "cannot join " + options.multicast_group);
  return {};
}

/// The family to open: AF_UNSPEC where nothing decides.
Result<int> family_of(const UdpSocketOptions& options) {
  int family = AF_UNSPEC;
  for (const std::string& text : {options.address, options.multicast_group}) {
    if (text.empty()) continue;
    const auto address = parse_ip_address(text);
    if (!address) {
      return fail(ErrorCode::usage, describe(options), "'" + text + "' is not a numeric IP address",
                  "write it like 192.0.2.7 or fe80::1");
    }
    const int wanted = address->v6 ? AF_INET6 : AF_INET;
    if (family != AF_UNSPEC && family != wanted) {
      return fail(ErrorCode::usage, describe(options),
                  "the address and the multicast group are of two families");
    }
    family = wanted;
  }
  return family;
}

}  // namespace

IpAddress address_of(const sockaddr_storage& storage) {
  if (storage.ss_family == AF_INET6) {
    std::array<std::uint8_t, 16> bytes{};
    std::memcpy(bytes.data(), &reinterpret_cast<const sockaddr_in6&>(storage).sin6_addr, 16);
    return IpAddress::v6_from(bytes);
  }
  std::array<std::uint8_t, 4> bytes{};
  std::memcpy(bytes.data(), &reinterpret_cast<const sockaddr_in&>(storage).sin_addr, 4);
  return IpAddress::v4_from(bytes);
}

std::uint16_t port_of(const sockaddr_storage& storage) {
  return storage.ss_family == AF_INET6 ? ntohs(reinterpret_cast<const sockaddr_in6&>(storage).sin6_port)
                                       : ntohs(reinterpret_cast<const sockaddr_in&>(storage).sin_port);
}

socklen_t to_sockaddr(const IpAddress& address, std::uint16_t port, unsigned scope,
                      sockaddr_storage& storage) {
  storage = {};
  if (address.v6) {
    auto& v6 = reinterpret_cast<sockaddr_in6&>(storage);
    v6.sin6_family = AF_INET6;
    v6.sin6_port = htons(port);
    v6.sin6_scope_id = address.link_local() || address.multicast() ? scope : 0;
    std::memcpy(&v6.sin6_addr, address.bytes.data(), 16);
    return sizeof(sockaddr_in6);
  }
  auto& v4 = reinterpret_cast<sockaddr_in&>(storage);
  v4.sin_family = AF_INET;
  v4.sin_port = htons(port);
  std::memcpy(&v4.sin_addr, address.bytes.data(), 4);
  return sizeof(sockaddr_in);
}

Result<UdpSocket> open_udp_socket(const UdpSocketOptions& options) {
  const Result<int> family = family_of(options);
  if (!family) return fail(family.error());
  unsigned scope = 0;
  if (!options.interface.empty()) {
    scope = if_nametoindex(options.interface.c_str());
    if (scope == 0) {
      return fail(ErrorCode::unavailable, describe(options),
                  "there is no interface '" + options.interface + "'", "`ip address` shows them");
    }
  }

  UdpSocket result;
  const bool any_family = *family == AF_UNSPEC;
  result.fd =
      UniqueFd(::socket(any_family ? AF_INET6 : *family, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  // Kernels without IPv6 say so here; one that has it switched off lets the dual-stack bind fail instead.
  bool use_v6 = *family != AF_INET && result.fd.valid();
  const auto open_v4 = [&] {
    result.fd = UniqueFd(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    use_v6 = false;
  };
  if (any_family && !result.fd.valid()) open_v4();

  for (;;) {
    if (!result.fd.valid()) return socket_error(options, "cannot open a socket");
    const int fd = result.fd.get();
    if (use_v6 && !set_flag(fd, IPPROTO_IPV6, IPV6_V6ONLY, any_family ? 0 : 1)) {
      return socket_error(options, "cannot set the socket's family");
    }
    if (options.share_port) {
      // Either suffices on Linux only if the other program chose the same: both fit every viewer.
      (void)set_flag(fd, SOL_SOCKET, SO_REUSEADDR, 1);
      (void)set_flag(fd, SOL_SOCKET, SO_REUSEPORT, 1);
    }
    IpAddress local;
    local.v6 = use_v6;
    if (!options.address.empty()) local = *parse_ip_address(options.address);
    sockaddr_storage storage{};
    const socklen_t length = to_sockaddr(local, options.port, scope, storage);
    if (::bind(fd, reinterpret_cast<const sockaddr*>(&storage), length) == 0) break;
    const bool no_v6_here = errno == EAFNOSUPPORT || errno == EADDRNOTAVAIL;
    if (!any_family || !use_v6 || !no_v6_here) return socket_error(options, "cannot bind");
    open_v4();
  }

  const int fd = result.fd.get();
  if (!set_flag(fd, SOL_SOCKET, SO_TIMESTAMPNS, 1) || !set_flag(fd, SOL_SOCKET, SO_RXQ_OVFL, 1)) {
    return socket_error(options, "cannot have packets stamped and drops counted");
  }
  if (!options.multicast_group.empty()) {
    if (auto joined = join(options, fd, *parse_ip_address(options.multicast_group), scope); !joined) {
      return fail(joined.error());
    }
  }
  sockaddr_storage bound{};
  socklen_t length = sizeof bound;
  if (::getsockname(fd, reinterpret_cast<sockaddr*>(&bound), &length) != 0) {
    return socket_error(options, "cannot ask for the port");
  }
  result.port = port_of(bound);
  result.v6 = use_v6;
  result.v4 = !use_v6 || any_family;
  size_receive_buffer(result, options.receive_buffer);
  return result;
}

}  // namespace ca2
