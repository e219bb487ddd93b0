#include "drivers/net/line_client.h"

#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>
#include <memory>

#include "drivers/net/unique_fd.h"

namespace ca2 {
namespace {

using Clock = std::chrono::steady_clock;

/// False when the deadline passes first.
bool wait_for(int fd, short events, Clock::time_point deadline) {
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
    if (left <= 0) return false;
    pollfd polled{fd, events, 0};
    const int ready = ::poll(&polled, 1, static_cast<int>(left));
    if (ready > 0) return true;
    if (ready < 0 && errno != EINTR) return false;
  }
}

/// A connected socket, or the reason why there is none in `reason`.
UniqueFd connect_to(const addrinfo* address, Clock::time_point deadline, std::string& reason) {
  for (; address != nullptr; address = address->ai_next) {
    UniqueFd fd(::socket(address->ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    if (!fd.valid()) continue;
    int code = 0;
    if (::connect(fd.get(), address->ai_addr, address->ai_addrlen) != 0) code = errno;
    if (code == EINPROGRESS) {
      code = ETIMEDOUT;
      socklen_t length = sizeof code;
      if (wait_for(fd.get(), POLLOUT, deadline)) ::getsockopt(fd.get(), SOL_SOCKET, SO_ERROR, &code, &length);
    }
    if (code == 0) return fd;
    reason = std::strerror(code);
  }
  return {};
}

}  // namespace

Result<std::string> LineClient::ask(const std::string& line) const {
  const Clock::time_point deadline = Clock::now() + options_.timeout;
  const std::string where = host_ + ":" + std::to_string(options_.port);
  const auto unavailable = [&](const std::string& why) {
    return fail(ErrorCode::unavailable, where, why, "is the sensor on, and on this network?");
  };
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const int code = getaddrinfo(host_.c_str(), std::to_string(options_.port).c_str(), &hints, &found);
  if (code != 0) return unavailable(gai_strerror(code));
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> addresses(found, &freeaddrinfo);
  std::string reason = "cannot connect";
  const UniqueFd fd = connect_to(addresses.get(), deadline, reason);
  if (!fd.valid()) return unavailable(reason);

  const std::string request = line + "\n";
  for (std::size_t sent = 0; sent < request.size();) {
    const auto part = ::send(fd.get(), request.data() + sent, request.size() - sent, MSG_NOSIGNAL);
    if (part > 0) {
      sent += static_cast<std::size_t>(part);
    } else if (errno != EAGAIN && errno != EINTR) {
      return unavailable(std::strerror(errno));
    } else if (!wait_for(fd.get(), POLLOUT, deadline)) {
      return unavailable("does not take the request");
    }
  }

  std::string reply;
  char buffer[4096];
  for (;;) {
    if (!wait_for(fd.get(), POLLIN, deadline)) {
      return unavailable("no complete answer in " + std::to_string(options_.timeout.count()) + " ms");
    }
    const auto part = ::recv(fd.get(), buffer, sizeof buffer, 0);
    if (part < 0 && (errno == EAGAIN || errno == EINTR)) continue;
    if (part <= 0) return unavailable("the connection ended before the answer did");
    const std::size_t before = reply.size();
    reply.append(buffer, static_cast<std::size_t>(part));
    const std::size_t end = reply.find('\n', before);
    if (end != std::string::npos) {
      reply.resize(end);
      if (!reply.empty() && reply.back() == '\r') reply.pop_back();
      return reply;
    }
    if (reply.size() > options_.longest_line) {
      return fail(ErrorCode::data, where,
                  "the answer is longer than " + std::to_string(options_.longest_line) + " bytes",
                  "is this address a LiDAR's?");
    }
  }
}

}  // namespace ca2
