/// @file `ca2 status`: what the daemon does, and what it wants next.
#include <CLI/CLI.hpp>
#include <ca2/status_v1_t.hpp>
#include <cstdio>
#include <lcm/lcm-cpp.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>

#include "messages/channels.h"
#include "messages/status.h"
#include "messages/well_formed.h"
#include "tools/ca2/command.h"
#include "tools/ca2/daemon_link.h"
#include "tools/ca2/follow_status.h"
#include "tools/ca2/interrupt.h"
#include "tools/ca2/number_in.h"
#include "tools/ca2/status_text.h"

namespace ca2 {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds reply_timeout{5000};

struct StatusArguments {
  DaemonAddress address;
  bool json = false, watch = false, from_lcm = false;
  double timeout = 5;  // s
};

void print(const DaemonStatus& status, const StatusArguments& arguments) {
  if (arguments.json) {
    std::printf("%s\n", to_json(status).dump(arguments.watch ? -1 : 2).c_str());
  } else if (arguments.watch) {
    std::printf("%s\n", status_line(status).c_str());
  } else {
    std::printf("%s", status_text(status).c_str());
  }
  std::fflush(stdout);
}

/// The live daemon's messages, or a log's that lcm-logplayer plays.
struct LcmListener {
  const StatusArguments& arguments;
  bool heard = false;

  void receive(const lcm::ReceiveBuffer* buffer, const std::string&) {
    const std::span bytes(static_cast<const std::uint8_t*>(buffer->data), buffer->data_size);
    status_v1_t message;
    if (!well_formed(layout::status_v1, bytes) ||
        message.decode(bytes.data(), 0, static_cast<int>(bytes.size())) < 0) {
      return;
    }
    if (heard && !arguments.watch) return;
    heard = true;
    print(from_lcm(message), arguments);
  }
};

Result<int> listen(const StatusArguments& arguments) {
  const std::string& url = arguments.address.lcm;
  lcm::LCM lcm(url);
  if (!lcm.good()) {
    return fail(ErrorCode::unavailable, url, "LCM cannot use this provider",
                "is there a route for multicast?");
  }
  LcmListener listener{arguments};
  lcm.subscribe(channel::status, &LcmListener::receive, &listener);
  const Interrupt interrupt;
  auto silent_until = std::chrono::steady_clock::now() + std::chrono::duration<double>(arguments.timeout);
  while (!Interrupt::raised() && (arguments.watch || !listener.heard)) {
    lcm.handleTimeout(100);
    if (!listener.heard && std::chrono::steady_clock::now() > silent_until) {
      return fail(ErrorCode::unavailable, url, "no status was heard", "does ca2d run, with this provider?");
    }
  }
  return 0;
}

Result<int> run(const StatusArguments& arguments) {
  if (arguments.from_lcm) return listen(arguments);
  if (arguments.watch) return follow_status(arguments.address, arguments.json);
  const auto reply = call_daemon(arguments.address, "status", nlohmann::json::object(), reply_timeout);
  if (!reply) return fail(reply.error());
  const Result<DaemonStatus> status = status_from_json(*reply);
  if (!status) return fail(status.error());
  print(*status, arguments);
  return 0;
}

}  // namespace

CommandBody setup_status(CLI::App& app) {
  auto arguments = std::make_shared<StatusArguments>();
  add_daemon_options(app, arguments->address);
  CLI::Option* lcm = app.get_option("--lcm");
  app.add_flag("--json", arguments->json, "For programs; with --watch one object per line");
  app.add_flag("--watch", arguments->watch, "Go on, a line whenever something changes");
  app.add_option("--timeout", arguments->timeout, "With --lcm: seconds to wait for the first status")
      ->capture_default_str()
      ->check(seconds());
  app.footer(
      "With --lcm alone the status is taken from CA2_STATUS, of a live daemon or of a log that is played.");
  return [arguments, lcm] {
    arguments->from_lcm = lcm->count() > 0 && arguments->address.key.empty();
    return run(*arguments);
  };
}

}  // namespace ca2
