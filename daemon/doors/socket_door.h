/// @file The control socket: commands and status for programs on this host.
#pragma once

#include <functional>
#include <list>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "daemon/dispatch/dispatcher.h"
#include "daemon/loop/event_loop.h"
#include "drivers/net/unique_fd.h"

namespace ca2 {

/// Lives in the loop's thread. Who may connect, may command: the socket's mode and group decide.
class SocketDoor {
 public:
  using Handler = std::function<void(const std::string& origin, const std::string& command,
                                     const nlohmann::json& arguments, CommandAnswer answer)>;

  /// ErrorCode::cannot_create; `unavailable` where another daemon listens already.
  static Result<std::unique_ptr<SocketDoor>> open(EventLoop& loop, const std::string& path, Handler handler);
  SocketDoor(const SocketDoor&) = delete;
  SocketDoor& operator=(const SocketDoor&) = delete;
  /// Removes the socket.
  ~SocketDoor();

  /// To all who subscribed. Who cannot read it fast enough does without this one.
  void send_status(const nlohmann::json& status);
  void send_event(const std::string& kind, const std::string& text);
  bool has_subscribers() const;

 private:
  struct Client;

  SocketDoor(EventLoop& loop, std::string path, Handler handler, UniqueFd listener);
  void accept();
  void read(const std::shared_ptr<Client>& client);
  void handle(const std::shared_ptr<Client>& client, std::string_view line);
  void send(Client& client, const nlohmann::json& message);
  void write(Client& client);
  void close(Client& client);
  void broadcast(const nlohmann::json& message);

  EventLoop& loop_;
  std::string path_;
  Handler handler_;
  UniqueFd listener_;
  std::list<std::shared_ptr<Client>> clients_;
};

}  // namespace ca2
