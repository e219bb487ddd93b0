/// @file HTTP to a sensor's own small web server: bounded in time and size, whatever it answers.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/types/result.h"

namespace ca2 {

struct HttpOptions {
  std::uint16_t port = 80;
  std::chrono::milliseconds timeout{5000};  ///< for a whole request, from connecting to the last byte
  std::size_t largest_body = 4u << 20;      ///< bytes; metadata has some 50 kB
};

struct HttpReply {
  int status = 0;  ///< 200, 404, ...
  std::string body;

  bool ok() const { return status >= 200 && status < 300; }
};

/// One request per connection; redirects are not followed, compression is not asked for.
class HttpClient {
 public:
  HttpClient(std::string host, HttpOptions options) : host_(std::move(host)), options_(options) {}

  /// `path` with its query, encoded already. Any status is an answer. Errors: `unavailable` when the host
  /// cannot be reached or does not finish in time, `data` for a body that is too large or cut off.
  Result<HttpReply> get(const std::string& path) const;
  Result<HttpReply> post(const std::string& path, const std::string& body,
                         const std::string& content_type) const;

  /// "http://host:port/path", for messages.
  std::string url(const std::string& path) const;

 private:
  Result<HttpReply> request(const char* method, const std::string& path, const std::string& body,
                            const std::string& content_type) const;

  std::string host_;
  HttpOptions options_;
};

/// Percent-encodes all but letters, digits and "-_.~".
std::string url_encode(std::string_view text);

}  // namespace ca2
