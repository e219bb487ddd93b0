#include "daemon/log.h"

#include <spdlog/logger.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/sinks/systemd_sink.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <memory>

namespace ca2::log {
namespace {

/// systemd says in JOURNAL_STREAM which file its journal reads: is it our stderr?
bool under_journal() {
  const char* stream = std::getenv("JOURNAL_STREAM");
  struct stat status {};
  if (!stream || ::fstat(STDERR_FILENO, &status) != 0) return false;
  unsigned long long device = 0, inode = 0;
  return std::sscanf(stream, "%llu:%llu", &device, &inode) == 2 && device == status.st_dev &&
         inode == status.st_ino;
}

std::unique_ptr<spdlog::logger> make_logger() {
  std::shared_ptr<spdlog::sinks::sink> sink;
  if (under_journal()) {
    sink = std::make_shared<spdlog::sinks::systemd_sink_mt>("ca2d", true);
    sink->set_pattern("%v");
  } else {
    sink = std::make_shared<spdlog::sinks::stderr_color_sink_mt>();
    sink->set_pattern("%Y-%m-%dT%H:%M:%S.%e %^%l%$ %v");
  }
  auto logger = std::make_unique<spdlog::logger>("ca2d", std::move(sink));
  // A log that cannot be written must not end the capture.
  logger->set_error_handler([](const std::string&) {});
  return logger;
}

spdlog::logger& logger() {
  static const std::unique_ptr<spdlog::logger> instance = make_logger();
  return *instance;
}

}  // namespace

bool set_level(const std::string& name) {
  const auto level = spdlog::level::from_str(name == "warning" ? "warn" : name == "error" ? "err" : name);
  if (level != spdlog::level::debug && level != spdlog::level::info && level != spdlog::level::warn &&
      level != spdlog::level::err) {
    return false;
  }
  logger().set_level(level);
  return true;
}

void write(Level level, const char* category, const std::string& text) {
  constexpr spdlog::level::level_enum levels[] = {spdlog::level::debug, spdlog::level::info,
                                                  spdlog::level::warn, spdlog::level::err};
  logger().log(levels[static_cast<int>(level)], "{}: {}", category, text);
}

}  // namespace ca2::log
