/// @file Sensors' servers on the loopback, answering as the vendors' documents say.
#pragma once

#include <httplib.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <atomic>
#include <functional>
#include <string>
#include <thread>

#include "drivers/net/unique_fd.h"

namespace ca2::test {

/// An HTTP server on a free port; add the routes, then start().
class FakeHttp {
 public:
  ~FakeHttp() {
    server.stop();
    if (thread_.joinable()) thread_.join();
  }
  void start() {
    port = static_cast<std::uint16_t>(server.bind_to_any_port("127.0.0.1"));
    thread_ = std::thread([this] { server.listen_after_bind(); });
    while (!server.is_running()) std::this_thread::yield();
  }

  httplib::Server server;
  std::uint16_t port = 0;

 private:
  std::thread thread_;
};

/// A TCP server on a free port: `answer` turns each connection's first bytes into what is sent back.
class FakeTcp {
 public:
  explicit FakeTcp(std::function<std::string(const std::string& request)> answer)
      : answer_(std::move(answer)) {
    listener_ = UniqueFd(::socket(AF_INET, SOCK_STREAM, 0));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t length = sizeof address;
    ::bind(listener_.get(), reinterpret_cast<sockaddr*>(&address), length);
    ::listen(listener_.get(), 8);
    ::getsockname(listener_.get(), reinterpret_cast<sockaddr*>(&address), &length);
    port = ntohs(address.sin_port);
    thread_ = std::thread([this] { serve(); });
  }
  ~FakeTcp() {
    stop_ = true;
    thread_.join();
  }

  std::uint16_t port = 0;

 private:
  void serve() {
    while (!stop_) {
      pollfd polled{listener_.get(), POLLIN, 0};
      if (::poll(&polled, 1, 20) <= 0) continue;
      const UniqueFd peer(::accept(listener_.get(), nullptr, nullptr));
      char buffer[4096];
      const auto got = ::recv(peer.get(), buffer, sizeof buffer, 0);
      if (got <= 0) continue;
      const std::string reply = answer_(std::string(buffer, static_cast<std::size_t>(got)));
      for (std::size_t sent = 0; sent < reply.size();) {
        const auto part = ::send(peer.get(), reply.data() + sent, reply.size() - sent, MSG_NOSIGNAL);
        if (part <= 0) break;
        sent += static_cast<std::size_t>(part);
      }
    }
  }

  std::function<std::string(const std::string&)> answer_;
  UniqueFd listener_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace ca2::test
