/// @file Datagrams out: for playing captures and for tests.
#pragma once

#include <sys/socket.h>

#include <cstdint>
#include <span>
#include <string>

#include "core/types/result.h"
#include "drivers/net/unique_fd.h"

namespace ca2 {

/// Sends to one host. Blocks while the kernel's queue is full.
class UdpSender {
 public:
  /// `host`: name or numeric address ("fe80::1%eth0" for link-local ones). Errors: `unavailable`.
  static Result<UdpSender> open(const std::string& host);

  /// Errors: `io`, with what the kernel said.
  Result<void> send(std::uint16_t port, std::span<const std::uint8_t> payload);

 private:
  UniqueFd fd_;
  std::string host_;
  sockaddr_storage address_{};
  socklen_t length_ = 0;
};

}  // namespace ca2
