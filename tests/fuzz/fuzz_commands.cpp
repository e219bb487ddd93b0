/// @file LCM messages that anybody on the network may send, and the JSON in them.
#include <ca2/command_v1_t.hpp>
#include <ca2/reply_v1_t.hpp>
#include <ca2/status_v1_t.hpp>
#include <nlohmann/json.hpp>

#include "core/io/json.h"
#include "messages/error_json.h"
#include "messages/signing.h"
#include "messages/status.h"
#include "messages/well_formed.h"
#include "tests/fuzz/fuzz_target.h"

namespace ca2::fuzz {
namespace {

template <class Message>
std::string encoded(char kind, const Message& message) {
  std::string bytes(static_cast<std::size_t>(message.getEncodedSize()), '\0');
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return kind + bytes;
}

/// What is well-formed and of the type is read to its last byte.
template <class Message>
bool decoded(std::string_view layout, const std::vector<std::uint8_t>& bytes, Message& message) {
  if (!well_formed(layout, bytes)) return false;
  const int size = static_cast<int>(bytes.size()), read = message.decode(bytes.data(), 0, size);
  require(read < 0 || read == size, "a part of a message");
  return read == size;
}

}  // namespace

/// The first byte chooses the message.
std::vector<std::string> seeds() {
  command_v1_t command{};
  command.sender = "pilot";
  command.command = "capture";
  command.arguments = R"({"now": true})";
  reply_v1_t reply{};
  reply.reply = R"({"ok": true})";
  DaemonStatus status;
  status.capture.sensors.resize(2);
  status.capture.next.emplace();
  return {encoded('\0', command), encoded('\1', reply), encoded('\2', to_lcm(status)),
          "\3" + to_json(status).dump()};
}

}  // namespace ca2::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace ca2;
  using fuzz::decoded;
  if (size == 0) return 0;
  const std::vector<std::uint8_t> bytes(data + 1, data + size);
  if (data[0] == 0) {
    command_v1_t command;
    if (!decoded(layout::command_v1, bytes, command)) return 0;
    (void)verify(SigningKey{}, command);
    (void)parse_json(command.arguments);
  } else if (data[0] == 1) {
    reply_v1_t reply;
    if (!decoded(layout::reply_v1, bytes, reply)) return 0;
    (void)verify(SigningKey{}, reply);
    const nlohmann::json json = parse_json(reply.reply);
    if (json.is_object()) (void)reply_from_json(json);
  } else if (data[0] == 2) {
    status_v1_t status;
    if (decoded(layout::status_v1, bytes, status)) (void)from_lcm(status);
  } else if (const auto json = parse_json({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
             json.is_object()) {
    if (const auto status = status_from_json(json))
      fuzz::require(status_from_json(to_json(*status)).has_value(), "what was written cannot be read");
  }
  return 0;
}
