/// @file The clients against servers that are slow, large, broken or absent.
#include <gtest/gtest.h>

#include <chrono>

#include "drivers/net/http_client.h"
#include "drivers/net/line_client.h"
#include "tests/drivers/lidar_config/fake_servers.h"

namespace ca2 {
namespace {

using namespace ca2::test;
using namespace std::chrono_literals;

HttpClient client_to(std::uint16_t port, std::chrono::milliseconds timeout = 2000ms) {
  HttpOptions options;
  options.port = port;
  options.timeout = timeout;
  options.largest_body = 100'000;
  return HttpClient("127.0.0.1", options);
}

class Timer {
 public:
  bool under(std::chrono::milliseconds limit) const {
    return std::chrono::steady_clock::now() - start_ < limit;
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

TEST(HttpClient, GetsAndPosts) {
  FakeHttp fake;
  fake.server.Get("/a", [](const httplib::Request& request, httplib::Response& response) {
    response.set_content("got " + request.get_param_value("args"), "text/plain");
  });
  fake.server.Post("/b", [](const httplib::Request& request, httplib::Response& response) {
    response.set_content(request.get_header_value("Content-Type") + ": " + request.body, "text/plain");
  });
  fake.start();
  const HttpClient client = client_to(fake.port);
  const auto got = client.get("/a?args=udp_dest+" + url_encode("[1, \"x\"]"));
  ASSERT_TRUE(got) << got.error().text();
  EXPECT_EQ(got->body, "got udp_dest [1, \"x\"]");
  const auto posted = client.post("/b", "{}", "application/json");
  ASSERT_TRUE(posted);
  EXPECT_EQ(posted->body, "application/json: {}");
  const auto missing = client.get("/none");
  ASSERT_TRUE(missing) << "any status is an answer";
  EXPECT_EQ(missing->status, 404);
  EXPECT_FALSE(missing->ok());
}

TEST(HttpClient, TakesABodyUpToTheLimitAndNoMore) {
  FakeHttp fake;
  fake.server.Get("/large", [](const httplib::Request&, httplib::Response& response) {
    response.set_content(std::string(100'000, 'x'), "text/plain");
  });
  fake.server.Get("/larger", [](const httplib::Request&, httplib::Response& response) {
    response.set_content(std::string(100'001, 'x'), "text/plain");
  });
  // No length announced, and no end.
  fake.server.Get("/endless", [](const httplib::Request&, httplib::Response& response) {
    response.set_chunked_content_provider("text/plain", [](std::size_t, httplib::DataSink& sink) {
      const std::string chunk(10'000, 'x');
      return sink.write(chunk.data(), chunk.size());
    });
  });
  fake.start();
  EXPECT_TRUE(client_to(fake.port).get("/large"));
  for (const char* path : {"/larger", "/endless"}) {
    const auto reply = client_to(fake.port).get(path);
    ASSERT_FALSE(reply) << path;
    EXPECT_EQ(reply.error().code, ErrorCode::data);
  }
}

TEST(HttpClient, DoesNotWaitLongerThanToldForAnyServer) {
  // Answers nothing; a header at a time; garbage and then nothing.
  FakeTcp silent([](const std::string&) {
    std::this_thread::sleep_for(1500ms);
    return std::string();
  });
  FakeHttp drip;
  drip.server.Get("/", [](const httplib::Request&, httplib::Response& response) {
    response.set_chunked_content_provider("text/plain", [](std::size_t offset, httplib::DataSink& sink) {
      std::this_thread::sleep_for(100ms);
      return offset < 30 && sink.write("x", 1);
    });
  });
  drip.start();
  for (const std::uint16_t port : {silent.port, drip.port}) {
    const Timer timer;
    const auto reply = client_to(port, 400ms).get("/");
    ASSERT_FALSE(reply);
    EXPECT_EQ(reply.error().code, ErrorCode::unavailable);
    EXPECT_TRUE(timer.under(1400ms));
  }
}

TEST(HttpClient, RefusesWhatIsNoHttp) {
  for (const std::string answer : {"", "\r\n\r\n", "HTTP/1.1 999999", "SSH-2.0-OpenSSH_9\r\n",
                                   "HTTP/1.1 200 OK\r\nContent-Length: 50\r\n\r\nshort"}) {
    FakeTcp fake([&](const std::string&) { return answer; });
    const auto reply = client_to(fake.port).get("/");
    EXPECT_FALSE(reply) << "'" << answer << "' gave '" << reply->body << "'";
  }
}

TEST(HttpClient, SaysThatNobodyIsThere) {
  std::uint16_t port = 0;
  {
    port = FakeTcp([](const std::string&) { return ""; }).port;
  }  // free again
  const auto reply = client_to(port).get("/");
  ASSERT_FALSE(reply);
  EXPECT_EQ(reply.error().code, ErrorCode::unavailable);
  EXPECT_FALSE(reply.error().problems[0].hint.empty());
}

LineClient line_client(std::uint16_t port) {
  LineOptions options;
  options.port = port;
  options.timeout = 400ms;
  options.longest_line = 10'000;
  return LineClient("127.0.0.1", options);
}

TEST(LineClient, AsksAndHears) {
  FakeTcp fake([](const std::string& request) { return "you said " + request + "and more\n"; });
  const auto reply = line_client(fake.port).ask("get_sensor_info");
  ASSERT_TRUE(reply) << reply.error().text();
  EXPECT_EQ(*reply, "you said get_sensor_info");
  FakeTcp windows([](const std::string&) { return "{}\r\n"; });
  EXPECT_EQ(*line_client(windows.port).ask("x"), "{}");
}

TEST(LineClient, IsBoundedInTimeAndSize) {
  FakeTcp silent([](const std::string&) {
    std::this_thread::sleep_for(900ms);
    return std::string("late\n");
  });
  const Timer timer;
  EXPECT_EQ(line_client(silent.port).ask("x").error().code, ErrorCode::unavailable);
  EXPECT_TRUE(timer.under(800ms));
  FakeTcp endless([](const std::string&) { return std::string(1'000'000, 'x'); });
  EXPECT_EQ(line_client(endless.port).ask("x").error().code, ErrorCode::data);
  FakeTcp cut([](const std::string&) { return "no end"; });
  EXPECT_EQ(line_client(cut.port).ask("x").error().code, ErrorCode::unavailable);
  std::uint16_t nobody = 0;
  {
    nobody = FakeTcp([](const std::string&) { return ""; }).port;
  }
  EXPECT_EQ(line_client(nobody).ask("x").error().code, ErrorCode::unavailable);
}

}  // namespace
}  // namespace ca2
