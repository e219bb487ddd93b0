#include "drivers/net/udp_sender.h"

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>

#include <cerrno>
#include <cstddef>
#include <cstring>

namespace ca2 {

Result<UdpSender> UdpSender::open(const std::string& host) {
  UdpSender sender;
  sender.host_ = host;
  addrinfo hints{};
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  const int code = getaddrinfo(host.c_str(), nullptr, &hints, &found);
  if (code != 0) return fail(ErrorCode::unavailable, host, gai_strerror(code));
  std::memcpy(&sender.address_, found->ai_addr, found->ai_addrlen);
  sender.length_ = found->ai_addrlen;
  sender.fd_ = UniqueFd(::socket(found->ai_family, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  freeaddrinfo(found);
  if (!sender.fd_.valid()) return fail(ErrorCode::unavailable, host, std::strerror(errno));
  const int yes = 1;  // to a broadcast address too: that is how Velodyne's sensors send
  (void)::setsockopt(sender.fd_.get(), SOL_SOCKET, SO_BROADCAST, &yes, sizeof yes);
  return sender;
}

Result<void> UdpSender::send(std::uint16_t port, std::span<const std::uint8_t> payload) {
  // The port sits at the same place in both families' addresses.
  static_assert(offsetof(sockaddr_in, sin_port) == offsetof(sockaddr_in6, sin6_port));
  reinterpret_cast<sockaddr_in&>(address_).sin_port = htons(port);
  for (;;) {
    const auto sent = ::sendto(fd_.get(), payload.data(), payload.size(), MSG_NOSIGNAL,
                               reinterpret_cast<const sockaddr*>(&address_), length_);
    if (sent >= 0) return {};
    if (errno == EINTR) continue;
    return fail(ErrorCode::io, host_ + ":" + std::to_string(port),
                std::string("cannot send: ") + std::strerror(errno));
  }
}

}  // namespace ca2
