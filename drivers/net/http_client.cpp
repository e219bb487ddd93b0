#include "drivers/net/http_client.h"

#include <httplib.h>

#include <condition_variable>
#include <mutex>
#include <thread>

namespace ca2 {
namespace {

/// Stops a request that a server draws out: httplib's own timeouts are per read.
class Watchdog {
 public:
  Watchdog(httplib::Client& client, std::chrono::milliseconds limit)
      : thread_([this, &client, limit] {
          std::unique_lock lock(mutex_);
          if (!done_signal_.wait_for(lock, limit, [this] { return done_; })) {
            expired_ = true;
            client.stop();
          }
        }) {}

  /// True if the time ran out.
  bool finish() {
    {
      const std::lock_guard lock(mutex_);
      done_ = true;
    }
    done_signal_.notify_one();
    thread_.join();
    return expired_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable done_signal_;
  bool done_ = false, expired_ = false;
  std::thread thread_;  ///< last: it uses the others
};

/// httplib's own words are the names of its errors.
std::string words_of(httplib::Error error) {
  switch (error) {
    case httplib::Error::Connection:
      return "no connection";
    case httplib::Error::Read:
    case httplib::Error::Write:
      return "the connection broke off";
    default:
      return httplib::to_string(error);
  }
}

}  // namespace

std::string HttpClient::url(const std::string& path) const {
  return "http://" + host_ + (options_.port == 80 ? "" : ":" + std::to_string(options_.port)) + path;
}

Result<HttpReply> HttpClient::get(const std::string& path) const {
  return request("GET", path, "", "");
}

Result<HttpReply> HttpClient::post(const std::string& path, const std::string& body,
                                   const std::string& content_type) const {
  return request("POST", path, body, content_type);
}

Result<HttpReply> HttpClient::request(const char* method, const std::string& path, const std::string& body,
                                      const std::string& content_type) const {
  httplib::Client client(host_, options_.port);
  client.set_url_encode(false);
  client.set_decompress(false);
  client.set_follow_location(false);
  client.set_connection_timeout(options_.timeout);
  client.set_read_timeout(options_.timeout);
  client.set_write_timeout(options_.timeout);

  HttpReply reply;
  bool too_large = false;
  httplib::Request request;
  request.method = method;
  request.path = path;
  request.body = body;
  request.headers = {{"Accept", "*/*"}};
  if (!content_type.empty()) request.headers.emplace("Content-Type", content_type);
  request.content_receiver = [&](const char* data, std::size_t size, std::uint64_t, std::uint64_t) {
    too_large = size > options_.largest_body - reply.body.size();
    if (!too_large) reply.body.append(data, size);
    return !too_large;
  };

  Watchdog watchdog(client, options_.timeout);
  const httplib::Result result = client.send(request);
  const bool expired = watchdog.finish();
  if (too_large) {
    return fail(ErrorCode::data, url(path),
                "the answer has more than " + std::to_string(options_.largest_body) + " bytes",
                "is this address a LiDAR's?");
  }
  if (expired || !result) {
    const std::string why = expired
                                ? "no complete answer in " + std::to_string(options_.timeout.count()) + " ms"
                                : words_of(result.error());
    return fail(ErrorCode::unavailable, url(path), why, "is the sensor on, and on this network?");
  }
  reply.status = result->status;
  return reply;
}

std::string url_encode(std::string_view text) {
  constexpr char digits[] = "0123456789ABCDEF";
  constexpr std::string_view plain = "-_.~";
  std::string encoded;
  for (const char letter : text) {
    const bool alphanumeric = (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') ||
                              (letter >= '0' && letter <= '9');
    if (alphanumeric || plain.find(letter) != std::string_view::npos) {
      encoded += letter;
    } else {
      const auto byte = static_cast<unsigned char>(letter);
      encoded += '%';
      encoded += digits[byte >> 4];
      encoded += digits[byte & 15];
    }
  }
  return encoded;
}

}  // namespace ca2
