/// @file The client against daemons that behave, misbehave and vanish.
#include "messages/control/client.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <thread>

#include "messages/control/line_buffer.h"
#include "messages/control/protocol.h"
#include "tests/support/temporary_directory.h"

namespace ca2::control {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;

const std::string hello = R"({"type":"hello","protocol":1,"software":"test"})"
                          "\n";

/// Listens, and runs a script with the first connection.
class FakeDaemon {
 public:
  explicit FakeDaemon(std::function<void(int fd)> script) {
    listener_ = ::socket(AF_UNIX, SOCK_STREAM, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path().copy(address.sun_path, sizeof(address.sun_path) - 1);
    EXPECT_EQ(::bind(listener_, reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
    EXPECT_EQ(::listen(listener_, 1), 0);
    thread_ = std::thread([this, script = std::move(script)] {
      const int fd = ::accept(listener_, nullptr, nullptr);
      script(fd);
      ::close(fd);
    });
  }
  ~FakeDaemon() {
    thread_.join();
    ::close(listener_);
  }
  std::string path() const { return (directory_ / "s").string(); }

 private:
  test::TemporaryDirectory directory_;
  int listener_ = -1;
  std::thread thread_;
};

void say(int fd, const std::string& text) {
  EXPECT_EQ(::send(fd, text.data(), text.size(), MSG_NOSIGNAL), static_cast<ssize_t>(text.size()));
}

/// Reads until a line's end.
std::string hear(int fd) {
  std::string line;
  for (char c = 0; ::read(fd, &c, 1) == 1 && c != '\n';) line += c;
  return line;
}

TEST(Client, CallsAndSkipsWhatIsNotTheReply) {
  FakeDaemon daemon([](int fd) {
    say(fd, hello);
    const json request = json::parse(hear(fd));
    EXPECT_EQ(request.at("command"), "drop");
    EXPECT_EQ(request.at("arguments").at("view"), 3);
    say(fd, R"({"type":"status"})"
            "\n");
    say(fd, R"({"type":"reply","id":1,)");
    say(fd, R"("result":{"views":2}})"
            "\n");
    hear(fd);
    say(fd, R"({"type":"reply","id":2,"error":{"code":64,"problems":[{"where":"","what":"no","hint":""}]}})"
            "\n");
    hear(fd);
  });
  Result<Client> client = Client::connect(daemon.path());
  ASSERT_TRUE(client) << client.error().text();
  const Result<json> reply = client->call("drop", {{"view", 3}}, milliseconds(5000));
  ASSERT_TRUE(reply) << reply.error().text();
  EXPECT_EQ(reply->at("views"), 2);
  const Result<json> refused = client->call("drop", {{"view", 9}}, milliseconds(5000));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::usage);
  // No reply, then the end.
  EXPECT_EQ(client->call("x", json::object(), milliseconds(5000)).error().code, ErrorCode::unavailable);
}

TEST(Client, ADaemonThatDoesNotAnswerIsUnavailable) {
  FakeDaemon daemon([](int fd) {
    say(fd, hello);
    hear(fd);
    hear(fd);  // returns when the client is gone
  });
  Result<Client> client = Client::connect(daemon.path());
  ASSERT_TRUE(client);
  EXPECT_EQ(client->call("x", json::object(), milliseconds(50)).error().code, ErrorCode::unavailable);
  EXPECT_TRUE(client->next(milliseconds(1))->is_null());
  client = fail(ErrorCode::internal, "", "");
}

TEST(Client, StrangersAreRefused) {
  for (const std::string& greeting : {std::string("hi\n"),
                                      std::string(R"({"type":"hello","protocol":2})"
                                                  "\n"),
                                      std::string("[1]\n"), std::string("\n")}) {
    FakeDaemon daemon([&](int fd) { say(fd, greeting); });
    EXPECT_EQ(Client::connect(daemon.path()).error().code, ErrorCode::data) << greeting;
  }
  FakeDaemon full([](int fd) {
    say(fd, R"({"type":"error","error":{"code":69,"problems":[{"where":"","what":"full","hint":""}]}})"
            "\n");
  });
  EXPECT_EQ(Client::connect(full.path()).error().code, ErrorCode::unavailable);
}

TEST(Client, NoDaemonIsUnavailable) {
  const test::TemporaryDirectory directory;
  EXPECT_EQ(Client::connect(directory / "none").error().code, ErrorCode::unavailable);
  EXPECT_EQ(Client::connect(std::string(200, 'x')).error().code, ErrorCode::usage);
}

TEST(LineBuffer, LinesInAnyPortions) {
  LineBuffer lines(10);
  const std::string text = "one\n\nthree\nrest";
  std::vector<std::string> found;
  for (const char c : text) {
    lines.append(std::string_view(&c, 1));
    while (const auto line = lines.next()) found.emplace_back(*line);
  }
  EXPECT_EQ(found, (std::vector<std::string>{"one", "", "three"}));
  EXPECT_FALSE(lines.overlong());
  lines.append("1234567");
  EXPECT_TRUE(lines.overlong());
}

}  // namespace
}  // namespace ca2::control
