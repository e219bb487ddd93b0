#include "daemon/doors/command_guard.h"

namespace ca2 {
namespace {

// A handheld's clock may be off by so much; what is recorded can be sent again no later. us.
constexpr std::int64_t window = 5'000'000;

}  // namespace

CommandGuard::CommandGuard(std::vector<NamedKey> keys, std::string host, std::int64_t start)
    : host_(std::move(host)), start_(start) {
  for (NamedKey& key : keys) senders_[key.sender] = {key.key, {}};
}

CommandGuard::Verdict CommandGuard::judge(const command_v1_t& command, std::int64_t now) {
  const Verdict verdict = this->verdict(command, now);
  if (verdict != Verdict::good && verdict != Verdict::for_another_host) ++refused_;
  return verdict;
}

/// Nothing is believed, and nothing remembered, of what is not signed.
CommandGuard::Verdict CommandGuard::verdict(const command_v1_t& command, std::int64_t now) {
  const auto sender = senders_.find(command.sender);
  if (sender == senders_.end()) return Verdict::unknown_sender;
  if (!verify(sender->second.key, command)) return Verdict::wrong_code;
  if (command.target != host_) return Verdict::for_another_host;
  // Numbers are forgotten when the daemon ends, so that nothing from before its start may count.
  if (command.utime < start_ || command.utime < now - window || command.utime > now + window) {
    return Verdict::stale;
  }
  if (sender->second.last && command.sequence <= *sender->second.last) return Verdict::replayed;
  sender->second.last = command.sequence;
  return Verdict::good;
}

const SigningKey* CommandGuard::key(const std::string& sender) const {
  const auto found = senders_.find(sender);
  return found == senders_.end() ? nullptr : &found->second.key;
}

const char* words(CommandGuard::Verdict verdict) {
  switch (verdict) {
    case CommandGuard::Verdict::good:
      return "obeyed";
    case CommandGuard::Verdict::for_another_host:
      return "for another host";
    case CommandGuard::Verdict::malformed:
      return "not a command";
    case CommandGuard::Verdict::unknown_sender:
      return "there is no key of this sender";
    case CommandGuard::Verdict::wrong_code:
      return "not signed with this sender's key";
    case CommandGuard::Verdict::stale:
      return "not sent just now: do the clocks agree?";
    case CommandGuard::Verdict::replayed:
      return "its number was used before";
  }
  return "";
}

}  // namespace ca2
