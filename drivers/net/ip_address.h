/// @file IPv4 and IPv6 addresses as values.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace ca2 {

/// An address in network byte order; IPv4 uses the first four bytes. The scope of link-local IPv6 addresses
/// is not part of it.
struct IpAddress {
  std::array<std::uint8_t, 16> bytes{};
  bool v6 = false;

  static IpAddress v4_from(std::span<const std::uint8_t, 4> network_order);
  /// IPv4-mapped addresses (::ffff:a.b.c.d, what a dual-stack socket reports) become the IPv4 they stand for.
  static IpAddress v6_from(std::span<const std::uint8_t, 16> network_order);

  bool multicast() const { return v6 ? bytes[0] == 0xff : (bytes[0] & 0xf0) == 0xe0; }
  bool link_local() const {
    return v6 ? bytes[0] == 0xfe && (bytes[1] & 0xc0) == 0x80 : bytes[0] == 169 && bytes[1] == 254;
  }
  std::string text() const;

  auto operator<=>(const IpAddress&) const = default;
};

/// Numeric addresses only ("192.0.2.7", "fe80::1", "fe80::1%eth0" whose scope is ignored, "[::1]").
std::optional<IpAddress> parse_ip_address(std::string_view text);

/// The text of an address that rarely changes: formats only when it does.
class AddressText {
 public:
  /// Valid until the next call.
  std::string_view of(const IpAddress& address);

 private:
  std::optional<IpAddress> address_;
  std::string text_;
};

}  // namespace ca2
