/// @file The log: to the journal under systemd, else to stderr.
#pragma once

#include <string>

namespace ca2::log {

enum class Level { debug, info, warning, error };

/// "debug", "info", "warning" or "error"; false for another word.
bool set_level(const std::string& name);

/// `category` is the module: "sensor", "store", "control", ... A change of state is one line, once; nothing
/// is logged per packet or frame.
void write(Level level, const char* category, const std::string& text);

inline void debug(const char* category, const std::string& text) {
  write(Level::debug, category, text);
}
inline void info(const char* category, const std::string& text) {
  write(Level::info, category, text);
}
inline void warning(const char* category, const std::string& text) {
  write(Level::warning, category, text);
}
inline void error(const char* category, const std::string& text) {
  write(Level::error, category, text);
}

}  // namespace ca2::log
