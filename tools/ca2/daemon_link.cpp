#include "tools/ca2/daemon_link.h"

#include <CLI/CLI.hpp>
#include <cstring>
#include <lcm/lcm-cpp.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>

#include <ca2/command_v1_t.hpp>
#include <ca2/reply_v1_t.hpp>

#include "core/io/json.h"
#include "messages/control/client.h"
#include "messages/error_json.h"
#include "messages/signing.h"
#include "messages/well_formed.h"

namespace ca2 {
namespace {

using nlohmann::json;
using Clock = std::chrono::steady_clock;

/// The reply to one command, rightly signed; everything else on the channel is passed over.
struct ReplyListener {
  const NamedKey& key;
  std::string host;
  std::int64_t sequence;
  std::optional<json> reply;

  void receive(const lcm::ReceiveBuffer* buffer, const std::string&) {
    const std::span bytes(static_cast<const std::uint8_t*>(buffer->data), buffer->data_size);
    reply_v1_t message;
    if (!well_formed(layout::reply_v1, bytes) ||
        message.decode(bytes.data(), 0, static_cast<int>(bytes.size())) < 0 || message.sender != key.sender ||
        message.source != host || message.sequence != sequence || !verify(key.key, message)) {
      return;
    }
    json parsed = parse_json(message.reply);
    if (!parsed.is_discarded()) reply = std::move(parsed);
  }
};

Result<json> call_signed(const DaemonAddress& address, const std::string& command, const json& arguments,
                         std::chrono::milliseconds timeout) {
  const Result<NamedKey> key = read_key(address.key);
  if (!key) return fail(key.error());
  if (address.host.empty()) {
    return fail(ErrorCode::usage, "", "--key needs --host, the name of the daemon's host");
  }
  lcm::LCM lcm(address.lcm);
  if (!lcm.good()) {
    return fail(ErrorCode::unavailable, address.lcm, "LCM cannot use this provider",
                "is there a route for multicast?");
  }
  command_v1_t message;
  message.utime = std::chrono::duration_cast<std::chrono::microseconds>(
                      std::chrono::system_clock::now().time_since_epoch())
                      .count();
  message.sender = key->sender;
  message.target = address.host;
  message.sequence = message.utime;  // rises as long as the clock does, across runs
  message.command = command;
  message.arguments = arguments.dump();
  std::memset(message.code, 0, sizeof(message.code));
  sign(key->key, message);

  ReplyListener listener{*key, address.host, message.sequence, {}};
  lcm.subscribe(channel::reply, &ReplyListener::receive, &listener);
  lcm.publish(channel::command, &message);
  for (const auto end = Clock::now() + timeout; !listener.reply && Clock::now() < end;) {
    lcm.handleTimeout(100);
  }
  if (listener.reply) return reply_from_json(*listener.reply);
  return fail(ErrorCode::unavailable, address.host, "no answer over LCM",
              "does ca2d run there, with this key in its control.keys, and do the clocks agree within 5 s?");
}

}  // namespace

void add_daemon_options(CLI::App& app, DaemonAddress& address) {
  app.add_option("--socket", address.socket, "The daemon's control socket")
      ->envname("CA2_SOCKET")
      ->capture_default_str();
  app.add_option("--key", address.key, "SENDER.key: command over LCM, signed with it, instead of the socket")
      ->envname("CA2_KEY");
  app.add_option("--host", address.host, "With --key: the name of the daemon's host")->envname("CA2_HOST");
  app.add_option("--lcm", address.lcm, "LCM provider")->capture_default_str();
}

Result<json> call_daemon(const DaemonAddress& address, const std::string& command, const json& arguments,
                         std::chrono::milliseconds timeout) {
  if (!address.key.empty()) return call_signed(address, command, arguments, timeout);
  Result<control::Client> client = control::Client::connect(address.socket);
  if (!client) return fail(client.error());
  return client->call(command, arguments, timeout);
}

}  // namespace ca2
