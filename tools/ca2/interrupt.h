/// @file Ctrl-C as a request to finish cleanly.
#pragma once

namespace ca2 {

class UdpSource;

/// While it lives, SIGINT and SIGTERM stop `source` (if any) and set raised(); the second one kills as usual.
/// One at a time.
class Interrupt {
 public:
  explicit Interrupt(UdpSource* source = nullptr);
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;
  ~Interrupt();

  static bool raised();
};

}  // namespace ca2
