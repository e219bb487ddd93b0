/// @file Keys, and the code that proves who sent a command (docs/security.md).
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>

#include "core/types/result.h"

namespace ca2 {

class command_v1_t;
class reply_v1_t;

/// A shared secret of libsodium's crypto_auth.
using SigningKey = std::array<std::uint8_t, 32>;

/// A key and whose it is: the file's name without ".key".
struct NamedKey {
  std::string sender;
  SigningKey key;
};

/// Makes a key of the system's random numbers in a new file of mode 0600. ErrorCode::usage for a file that is
/// not called SENDER.key, `cannot_create` where there is one already.
Result<NamedKey> make_key(const std::filesystem::path& file);

/// Refused (ErrorCode::config): a file that others than its owner and group may read, or that holds no key.
Result<NamedKey> read_key(const std::filesystem::path& file);

/// Fills in the code; everything else must be filled in before.
void sign(const SigningKey& key, command_v1_t& message);
void sign(const SigningKey& key, reply_v1_t& message);

/// Is the code right? In constant time.
bool verify(const SigningKey& key, const command_v1_t& message);
bool verify(const SigningKey& key, const reply_v1_t& message);

}  // namespace ca2
