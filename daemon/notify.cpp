#include "daemon/notify.h"

#include <systemd/sd-daemon.h>

namespace ca2::notify {

void ready() {
  sd_notify(0, "READY=1");
}

void reloading() {
  sd_notify(0, "RELOADING=1");
}

void stopping() {
  sd_notify(0, "STOPPING=1");
}

void status(const std::string& text) {
  // A line's end would begin another assignment.
  sd_notify(0, ("STATUS=" + text.substr(0, text.find('\n'))).c_str());
}

void watchdog() {
  sd_notify(0, "WATCHDOG=1");
}

std::optional<std::chrono::milliseconds> watchdog_period() {
  std::uint64_t us = 0;
  if (sd_watchdog_enabled(0, &us) <= 0) return std::nullopt;
  return std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::microseconds(us));
}

}  // namespace ca2::notify
