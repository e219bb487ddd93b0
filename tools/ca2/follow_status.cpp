#include "tools/ca2/follow_status.h"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "messages/control/client.h"
#include "messages/status.h"
#include "tools/ca2/interrupt.h"
#include "tools/ca2/status_text.h"

namespace ca2 {

Result<int> follow_status(const DaemonAddress& address, bool json) {
  Result<control::Client> client = control::Client::connect(address.socket);
  if (!client) return fail(client.error());
  const auto subscribed = client->call("subscribe", nlohmann::json::object(), std::chrono::seconds(5));
  if (!subscribed) return fail(subscribed.error());
  const Interrupt interrupt;
  std::string last;
  while (!Interrupt::raised()) {
    const Result<nlohmann::json> message = client->next(std::chrono::milliseconds(200));
    // A daemon that ends while this is ending is none that went away.
    if (!message && Interrupt::raised()) break;
    if (!message) return fail(message.error());
    if (message->is_null() || message->value("type", "") != "status") continue;
    const Result<DaemonStatus> status = status_from_json(message->at("status"));
    if (!status) return fail(status.error());
    const std::string line = json ? to_json(*status).dump() : status_line(*status);
    if (line != last) std::printf("%s\n", line.c_str());
    std::fflush(stdout);
    last = line;
  }
  return 0;
}

}  // namespace ca2
