#include "daemon/doors/socket_door.h"

#include <sys/epoll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <cerrno>
#include <nlohmann/json.hpp>
#include <system_error>

#include "ca2_version.h"
#include "core/io/json.h"
#include "core/types/text.h"
#include "daemon/doors/rate_limit.h"
#include "daemon/log.h"
#include "messages/control/line_buffer.h"
#include "messages/control/protocol.h"
#include "messages/error_json.h"

namespace ca2 {
namespace {

using nlohmann::json;

constexpr std::size_t most_clients = 16;
constexpr double commands_per_second = 50, burst = 100;
// A subscriber on a slow link does without a status rather than have it late; a client that lets more than
// this pile up does not read at all.
constexpr std::size_t skip_above = 256u << 10, give_up_above = 16u << 20;

std::string text_of(const json& message) {
  return message.dump(-1, ' ', false, json::error_handler_t::replace) + "\n";
}

/// Is somebody at the other end of this socket's file?
bool answered(const sockaddr_un& address) {
  const UniqueFd probe(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  return ::connect(probe.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
}

}  // namespace

struct SocketDoor::Client {
  UniqueFd fd;
  std::string origin;  ///< "uid 1000", for the log
  control::LineBuffer lines{control::max_request};
  RateLimit limit{commands_per_second, burst};
  std::string outgoing;  ///< not yet taken by the kernel
  bool subscribed = false;
  bool open = true;
};

Result<std::unique_ptr<SocketDoor>> SocketDoor::open(EventLoop& loop, const std::string& path,
                                                     Handler handler) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof(address.sun_path)) {
    return fail(ErrorCode::config, path, "is no path of a socket: 1 to 107 bytes");
  }
  path.copy(address.sun_path, path.size());
  const auto failure = [&](const char* what) {
    return fail(ErrorCode::cannot_create, path,
                std::string(what) + ": " + std::generic_category().message(errno),
                "does its directory exist, and may this user write there?");
  };
  if (answered(address)) {
    return fail(ErrorCode::unavailable, path, "another ca2d listens there already",
                "stop it, or give this one another control.socket");
  }
  ::unlink(path.c_str());  // what a killed daemon left behind
  UniqueFd listener(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!listener.valid()) return failure("no socket");
  // The mode before anybody can connect: 0660, the daemon's group may command.
  const mode_t before = ::umask(0117);
  const int bound = ::bind(listener.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address));
  ::umask(before);
  if (bound != 0) return failure("cannot be bound");
  if (::listen(listener.get(), most_clients) != 0) return failure("cannot listen");
  return std::unique_ptr<SocketDoor>(new SocketDoor(loop, path, std::move(handler), std::move(listener)));
}

SocketDoor::SocketDoor(EventLoop& loop, std::string path, Handler handler, UniqueFd listener)
    : loop_(loop), path_(std::move(path)), handler_(std::move(handler)), listener_(std::move(listener)) {
  loop_.watch(listener_.get(), EPOLLIN, [this](std::uint32_t) { accept(); });
}

SocketDoor::~SocketDoor() {
  loop_.forget(listener_.get());
  for (const auto& client : clients_) close(*client);
  ::unlink(path_.c_str());
}

void SocketDoor::accept() {
  UniqueFd fd(::accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
  if (!fd.valid()) return;
  std::erase_if(clients_, [](const auto& client) { return !client->open; });
  auto client = std::make_shared<Client>();
  client->fd = std::move(fd);
  ucred peer{};
  socklen_t size = sizeof(peer);
  if (::getsockopt(client->fd.get(), SOL_SOCKET, SO_PEERCRED, &peer, &size) == 0) {
    client->origin = formatted("uid %u", peer.uid);
  }
  if (clients_.size() >= most_clients) {
    const Error full(ErrorCode::unavailable, "",
                     formatted("the daemon serves %zu clients already", most_clients), "close one of them");
    send(*client, {{"type", "error"}, {"error", error_to_json(full)}});
    return;
  }
  clients_.push_back(client);
  loop_.watch(client->fd.get(), EPOLLIN, [this, client](std::uint32_t events) {
    if (events & EPOLLOUT) write(*client);
    if (client->open && (events & (EPOLLIN | EPOLLHUP | EPOLLERR))) read(client);
  });
  send(*client, {{"type", "hello"}, {"protocol", control::version}, {"software", "ca2 " CA2_VERSION}});
}

void SocketDoor::read(const std::shared_ptr<Client>& client) {
  char bytes[16384];
  const ssize_t size = ::recv(client->fd.get(), bytes, sizeof(bytes), 0);
  if (size < 0 && (errno == EAGAIN || errno == EINTR)) return;
  if (size <= 0) return close(*client);
  client->lines.append(std::string_view(bytes, static_cast<std::size_t>(size)));
  while (client->open) {
    const auto line = client->lines.next();
    if (!line) break;
    // A copy: what is answered may make the client's buffers move.
    handle(client, std::string(*line));
  }
  if (client->open && client->lines.overlong()) {
    log::warning("control", client->origin + ": a request of more than 64 KiB; disconnected");
    close(*client);
  }
}

void SocketDoor::handle(const std::shared_ptr<Client>& client, std::string_view line) {
  const json request = parse_json(line);
  const bool understood = request.is_object() && request.contains("id") &&
                          request["id"].is_number_integer() && request.contains("command") &&
                          request["command"].is_string();
  const json id = understood ? request["id"] : json(nullptr);
  const auto answer = [this, weak = std::weak_ptr(client), id](const Result<json>& reply) {
    const auto waiting = weak.lock();
    if (!waiting || !waiting->open) return;
    json message = reply_to_json(reply);
    message["type"] = "reply";
    message["id"] = id;
    send(*waiting, message);
  };
  if (line.size() > control::max_request) {
    return answer(fail(ErrorCode::usage, "", "a request is 64 KiB at most"));
  }
  if (!understood) {
    return answer(fail(ErrorCode::usage, "", "a request is {\"id\": number, \"command\": text, ...}"));
  }
  if (!client->limit.allow(RateLimit::Clock::now())) {
    return answer(fail(ErrorCode::unavailable, "", "too many commands", "50 per second are the most"));
  }
  if (request["command"] == "subscribe") {
    client->subscribed = true;
    return answer(json::object());
  }
  const json arguments = request.contains("arguments") ? request["arguments"] : json::object();
  handler_(client->origin, request["command"], arguments, answer);
}

void SocketDoor::send(Client& client, const json& message) {
  client.outgoing += text_of(message);
  if (client.outgoing.size() > give_up_above) {
    log::warning("control", client.origin + " does not read; disconnected");
    return close(client);
  }
  write(client);
}

void SocketDoor::write(Client& client) {
  while (!client.outgoing.empty()) {
    const ssize_t size =
        ::send(client.fd.get(), client.outgoing.data(), client.outgoing.size(), MSG_NOSIGNAL);
    if (size < 0 && errno == EINTR) continue;
    if (size < 0 && errno == EAGAIN) break;
    if (size < 0) return close(client);
    client.outgoing.erase(0, static_cast<std::size_t>(size));
  }
  const auto known = [&](const auto& other) { return other.get() == &client; };
  if (std::none_of(clients_.begin(), clients_.end(), known)) return;  // turned away: not watched
  loop_.change(client.fd.get(), client.outgoing.empty() ? EPOLLIN : EPOLLIN | EPOLLOUT);
}

void SocketDoor::close(Client& client) {
  if (!client.open) return;
  client.open = false;
  loop_.forget(client.fd.get());
  client.fd.reset();
  client.outgoing.clear();
}

void SocketDoor::broadcast(const json& message) {
  // One that is closed meanwhile stays in the list until the next one comes.
  for (const auto& client : clients_) {
    if (client->open && client->subscribed && client->outgoing.size() < skip_above) send(*client, message);
  }
}

void SocketDoor::send_status(const json& status) {
  broadcast({{"type", "status"}, {"status", status}});
}

void SocketDoor::send_event(const std::string& kind, const std::string& text) {
  broadcast({{"type", "event"}, {"kind", kind}, {"text", text}});
}

bool SocketDoor::has_subscribers() const {
  return std::any_of(clients_.begin(), clients_.end(),
                     [](const auto& client) { return client->open && client->subscribed; });
}

}  // namespace ca2
