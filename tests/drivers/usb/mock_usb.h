/// @file A USB device that exists only in this process: umockdev answers what libusb asks the kernel.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace ca2::test {

using Bytes = std::vector<std::uint8_t>;

struct MockUsbDevice {
  std::string place = "1-1";  ///< in /sys; bus 1
  int address = 2;
  std::uint16_t vendor = 0, product = 0;
  std::string speed = "480";  ///< as /sys has it, Mbit/s
  std::string serial;
  std::vector<std::uint8_t> endpoints;  ///< bulk

  // What the device does; called in umockdev's thread.
  std::function<int()> claim = [] { return 0; };  ///< 0 or an errno
  std::function<int(std::uint8_t endpoint, std::span<const std::uint8_t>)> written =
      [](std::uint8_t, std::span<const std::uint8_t>) { return 0; };  ///< 0 or an errno of the submission
  /// What the host gets to read; nothing: not yet, the transfer waits.
  std::function<std::optional<Bytes>(std::uint8_t endpoint)> read = [](std::uint8_t) { return std::nullopt; };
};

/// The only USB devices there are, as long as it lives.
class MockUsb {
 public:
  MockUsb();
  ~MockUsb();
  void plug_in(const MockUsbDevice& device);

  /// Does this process run under umockdev-wrapper?
  static bool possible();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace ca2::test
