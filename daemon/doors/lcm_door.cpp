#include "daemon/doors/lcm_door.h"

#include <unistd.h>

#include <algorithm>
#include <ca2/reply_v1_t.hpp>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/io/json.h"
#include "core/types/text.h"
#include "daemon/log.h"
#include "drivers/camera/host_time.h"
#include "messages/channels.h"
#include "messages/control/protocol.h"
#include "messages/error_json.h"
#include "messages/well_formed.h"

namespace ca2 {
namespace {

using nlohmann::json;

constexpr int most_queued = 16;

std::int64_t now_us() {
  return utc_now() / 1000;
}

}  // namespace

std::string host_name() {
  char name[256] = "";
  ::gethostname(name, sizeof(name) - 1);
  return name;
}

std::vector<NamedKey> read_keys(const std::string& directory) {
  std::vector<NamedKey> keys;
  std::error_code error;
  std::vector<std::filesystem::path> files;
  for (std::filesystem::directory_iterator at(directory, error), end; !error && at != end;
       at.increment(error)) {
    if (at->path().extension() == ".key") files.push_back(at->path());
  }
  std::sort(files.begin(), files.end());
  for (const auto& file : files) {
    if (auto key = read_key(file)) {
      keys.push_back(std::move(*key));
    } else {
      log::warning("control", key.error().text());
    }
  }
  return keys;
}

LcmDoor::LcmDoor(lcm::LCM& lcm, std::vector<NamedKey> keys, Handler handler)
    : lcm_(lcm), host_(host_name()), guard_(std::move(keys), host_, now_us()), handler_(std::move(handler)) {
  // Untyped: what does not decode is to be counted too.
  subscription_ = lcm_.subscribe(channel::command, &LcmDoor::receive, this);
  subscription_->setQueueCapacity(most_queued);
}

LcmDoor::~LcmDoor() {
  *alive_ = false;
  lcm_.unsubscribe(subscription_);
}

void LcmDoor::refuse(const std::string& sender, CommandGuard::Verdict verdict) {
  if (!log_limit_.allow(RateLimit::Clock::now())) return;
  const bool printable = std::all_of(sender.begin(), sender.end(), [](char c) { return c > ' ' && c < 127; });
  log::warning("control", formatted("a command over LCM (sender '%s') was refused: %s; %llu so far",
                                    printable ? sender.substr(0, 64).c_str() : "?", words(verdict),
                                    static_cast<unsigned long long>(guard_.refused())));
}

void LcmDoor::receive(const lcm::ReceiveBuffer* buffer, const std::string&) {
  command_v1_t command;
  const std::span bytes(static_cast<const std::uint8_t*>(buffer->data), buffer->data_size);
  const int size = static_cast<int>(std::min(bytes.size(), control::max_request + 1));
  const bool decoded = bytes.size() <= control::max_request && well_formed(layout::command_v1, bytes) &&
                       command.decode(bytes.data(), 0, size) == size;
  if (!decoded) {
    guard_.count_malformed();
    return refuse("", CommandGuard::Verdict::malformed);
  }
  const CommandGuard::Verdict verdict = guard_.judge(command, now_us());
  if (verdict == CommandGuard::Verdict::for_another_host) return;
  if (verdict != CommandGuard::Verdict::good) return refuse(command.sender, verdict);

  const auto answer = [this, alive = alive_, sender = command.sender,
                       sequence = command.sequence](const Result<json>& result) {
    if (*alive) reply(sender, sequence, result);
  };
  const json arguments = parse_json(command.arguments);
  if (arguments.is_discarded()) {
    return answer(fail(ErrorCode::usage, "", "the arguments are not JSON"));
  }
  handler_("lcm " + command.sender, command.command, arguments, answer);
}

void LcmDoor::reply(const std::string& sender, std::int64_t sequence, const Result<json>& answer) {
  reply_v1_t message;
  message.utime = now_us();
  message.sender = sender;
  message.source = host_;
  message.sequence = sequence;
  message.reply = reply_to_json(answer).dump(-1, ' ', false, json::error_handler_t::replace);
  std::memset(message.code, 0, sizeof(message.code));
  sign(*guard_.key(sender), message);
  lcm_.publish(channel::reply, &message);
}

}  // namespace ca2
