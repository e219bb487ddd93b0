#include "messages/signing.h"

#include <sodium.h>
#include <sys/stat.h>

#include <algorithm>
#include <ca2/command_v1_t.hpp>
#include <ca2/reply_v1_t.hpp>
#include <cstring>
#include <stdexcept>
#include <vector>

#include "core/io/files.h"
#include "core/session/rig.h"

namespace ca2 {
namespace {

namespace fs = std::filesystem;

static_assert(sizeof(SigningKey) == crypto_auth_KEYBYTES);
static_assert(sizeof(command_v1_t::code) == crypto_auth_BYTES);
static_assert(sizeof(reply_v1_t::code) == crypto_auth_BYTES);

constexpr std::string_view extension = ".key";

void prepare() {
  if (sodium_init() < 0) throw std::runtime_error("libsodium cannot be initialised");
}

/// What is signed: the message's encoding, which begins with its type's fingerprint, without the code.
template <class Message>
std::vector<std::uint8_t> signed_bytes(Message message) {
  std::memset(message.code, 0, sizeof(message.code));
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

template <class Message>
void sign_message(const SigningKey& key, Message& message) {
  prepare();
  const auto bytes = signed_bytes(message);
  crypto_auth(message.code, bytes.data(), bytes.size(), key.data());
}

template <class Message>
bool verify_message(const SigningKey& key, const Message& message) {
  prepare();
  const auto bytes = signed_bytes(message);
  return crypto_auth_verify(message.code, bytes.data(), bytes.size(), key.data()) == 0;
}

/// Senders' names are held to what sensors' names are: they go into messages and logs.
Result<std::string> sender_of(const fs::path& file) {
  if (file.extension() == extension && valid_sensor_name(file.stem().string())) return file.stem().string();
  return fail(ErrorCode::usage, file.string(), "a key's file must be called SENDER.key",
              "SENDER is 1 to 64 letters, digits, '_' and '-'");
}

}  // namespace

Result<NamedKey> make_key(const fs::path& file) {
  prepare();
  const Result<std::string> sender = sender_of(file);
  if (!sender) return fail(sender.error());
  NamedKey named{*sender, {}};
  crypto_auth_keygen(named.key.data());
  char text[2 * sizeof(SigningKey) + 1];
  sodium_bin2hex(text, sizeof(text), named.key.data(), named.key.size());
  // Before the content: the file must at no moment be readable by others.
  const mode_t before = ::umask(0077);
  const Result<void> written = write_new(file, std::string(text) + "\n");
  ::umask(before);
  if (!written) return fail(written.error());
  return named;
}

Result<NamedKey> read_key(const fs::path& file) {
  const Result<std::string> sender = sender_of(file);
  if (!sender) return fail(sender.error());
  const Result<std::string> text = read_text(file, 1024);
  if (!text) return fail(text.error());
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0 || (status.st_mode & 07) != 0) {
    return fail(ErrorCode::config, file.string(), "everyone may read or write this key",
                "chmod 0640 it; if others had access, make a new one");
  }
  NamedKey named{*sender, {}};
  std::size_t size = 0;
  const char* end = nullptr;
  const bool read = sodium_hex2bin(named.key.data(), named.key.size(), text->data(), text->size(), nullptr,
                                   &size, &end) == 0;
  const std::string_view rest(end, read ? static_cast<std::size_t>(text->data() + text->size() - end) : 0);
  if (!read || size != named.key.size() || (rest != "\n" && !rest.empty())) {
    return fail(ErrorCode::config, file.string(), "is not a key of 64 hexadecimal digits",
                "`ca2 key new` makes one");
  }
  return named;
}

void sign(const SigningKey& key, command_v1_t& message) {
  sign_message(key, message);
}
void sign(const SigningKey& key, reply_v1_t& message) {
  sign_message(key, message);
}
bool verify(const SigningKey& key, const command_v1_t& message) {
  return verify_message(key, message);
}
bool verify(const SigningKey& key, const reply_v1_t& message) {
  return verify_message(key, message);
}

}  // namespace ca2
