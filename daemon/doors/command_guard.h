/// @file Which commands from the network are obeyed.
#pragma once

#include <ca2/command_v1_t.hpp>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "messages/signing.h"

namespace ca2 {

/// Pure: times are passed in, us since 1970.
class CommandGuard {
 public:
  enum class Verdict {
    good,
    for_another_host,  ///< rightly signed, but not meant here: no offence
    malformed,
    unknown_sender,
    wrong_code,
    stale,     ///< not sent just now, or sent before this daemon began
    replayed,  ///< of a number that was used
  };

  CommandGuard(std::vector<NamedKey> keys, std::string host, std::int64_t start);

  /// Judges what came in; a good one uses up its number.
  Verdict judge(const command_v1_t& command, std::int64_t now);
  void count_malformed() { ++refused_; }

  const SigningKey* key(const std::string& sender) const;
  std::uint64_t refused() const { return refused_; }

 private:
  struct Sender {
    SigningKey key;
    std::optional<std::int64_t> last;  ///< sequence
  };

  Verdict verdict(const command_v1_t& command, std::int64_t now);

  std::map<std::string, Sender> senders_;
  std::string host_;
  std::int64_t start_;
  std::uint64_t refused_ = 0;
};

const char* words(CommandGuard::Verdict verdict);

}  // namespace ca2
