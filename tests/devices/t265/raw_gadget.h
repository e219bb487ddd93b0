/// @file A USB device made of this process, through the kernel's raw_gadget on a dummy controller. It is
/// unplugged when the process ends.
#pragma once

#include <linux/usb/ch9.h>

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace ca2::test {

using Bytes = std::vector<std::uint8_t>;

struct GadgetEndpoint {
  std::uint8_t address = 0;  ///< bit 7: to the host
  bool interrupt = false;    ///< else bulk
};

struct GadgetDescription {
  std::uint16_t vendor = 0, product = 0;
  bool super_speed = false;               ///< else USB 2
  std::string serial;                     ///< empty: has none
  std::vector<GadgetEndpoint> endpoints;  ///< of its one interface, which is of the vendor's class
};

class RawGadget {
 public:
  /// Plugs it in. Throws std::system_error when the kernel refuses.
  explicit RawGadget(GadgetDescription description);

  /// Answers the host's control requests for ever. `configured` is called when the endpoints are ready;
  /// `vendor` gets each vendor request without data.
  void serve(std::function<void()> configured, std::function<void(std::uint8_t request)> vendor);

  /// Blocks until the host has sent one transfer, at most `limit` bytes.
  Bytes read(std::uint8_t endpoint, std::size_t limit);
  /// Blocks until the host has taken it.
  void write(std::uint8_t endpoint, std::span<const std::uint8_t> bytes);

 private:
  Bytes device_descriptor() const;
  Bytes configuration_descriptor() const;
  Bytes string_descriptor(int index) const;
  /// What answers a standard request; false: refused.
  bool standard(const usb_ctrlrequest& request, Bytes& answer);
  usb_endpoint_descriptor endpoint_descriptor(const GadgetEndpoint& endpoint) const;
  void enable_endpoints();
  int handle_of(std::uint8_t endpoint) const;

  GadgetDescription description_;
  int fd_ = -1;
  std::vector<int> handles_;  ///< of the kernel, by endpoint
};

}  // namespace ca2::test
