/// @file A line out, a line back, over TCP: how the first Ouster firmware is talked to.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "core/types/result.h"

namespace ca2 {

struct LineOptions {
  std::uint16_t port = 7501;
  std::chrono::milliseconds timeout{10000};  ///< for a whole exchange
  std::size_t longest_line = 1u << 20;       ///< bytes
};

/// One connection per exchange.
class LineClient {
 public:
  LineClient(std::string host, LineOptions options) : host_(std::move(host)), options_(options) {}

  /// Sends `line` and a newline; the line that comes back, without its end. Errors: `unavailable` when
  /// the host cannot be reached or does not answer in time, `data` for a line that is too long.
  Result<std::string> ask(const std::string& line) const;

 private:
  std::string host_;
  LineOptions options_;
};

}  // namespace ca2
