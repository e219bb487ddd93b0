/// @file The daemon, as its clients see it through the control socket.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/types/result.h"

namespace ca2::control {

class Client {
 public:
  /// Connects and reads the hello. ErrorCode::unavailable: no daemon listens there; `no_permission`: the
  /// socket is not for this user; `data`: another protocol.
  static Result<Client> connect(const std::filesystem::path& socket);
  Client(Client&&) noexcept;
  Client& operator=(Client&&) noexcept;
  ~Client();

  /// Sends a command and waits for its reply. What the daemon refuses comes back as its own error;
  /// `unavailable` when it does not answer in time or goes away.
  Result<nlohmann::json> call(const std::string& command, const nlohmann::json& arguments,
                              std::chrono::milliseconds timeout);

  /// For those who wait for several things at once (`ca2 watch`): sends without waiting, and the id by which
  /// the reply is known. Replies and what was subscribed to come from next().
  Result<std::int64_t> send(const std::string& command, const nlohmann::json& arguments);
  /// The next message from the daemon; null when none comes in time.
  Result<nlohmann::json> next(std::chrono::milliseconds timeout);
  /// To poll for reading; a message that is already here does not show there, so ask next() first.
  int descriptor() const;

 private:
  struct State;
  explicit Client(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace ca2::control
