/// @file How the commands to the daemon reach it: the control socket, or signed LCM for a handheld.
#pragma once

#include <chrono>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/types/result.h"
#include "messages/channels.h"
#include "messages/control/protocol.h"

namespace CLI {
class App;
}

namespace ca2 {

struct DaemonAddress {
  std::string socket = control::default_socket;  ///< of the daemon on this host
  std::string lcm = default_lcm_url;             ///< provider
  std::string key;   ///< SENDER.key: signed commands instead of the socket; empty: the socket
  std::string host;  ///< with a key: name of the host that the daemon is on
};

/// Declares --socket, and --key, --host, --lcm.
void add_daemon_options(CLI::App& app, DaemonAddress& address);

/// One command and its answer. The daemon's own errors come back as they are; ErrorCode::unavailable when
/// there is no daemon, or no answer in time.
Result<nlohmann::json> call_daemon(const DaemonAddress& address, const std::string& command,
                                   const nlohmann::json& arguments, std::chrono::milliseconds timeout);

}  // namespace ca2
