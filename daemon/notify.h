/// @file What systemd is told (sd_notify(3)); nothing happens without systemd.
#pragma once

#include <chrono>
#include <optional>
#include <string>

namespace ca2::notify {

void ready();
void reloading();
void stopping();
/// One line for `systemctl status`.
void status(const std::string& text);
/// A sign of life.
void watchdog();
/// How often a sign is due at least; nothing: no watchdog.
std::optional<std::chrono::milliseconds> watchdog_period();

}  // namespace ca2::notify
