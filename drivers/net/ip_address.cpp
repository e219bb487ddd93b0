#include "drivers/net/ip_address.h"

#include <arpa/inet.h>

#include <algorithm>

namespace ca2 {

IpAddress IpAddress::v4_from(std::span<const std::uint8_t, 4> network_order) {
  IpAddress address;
  std::copy(network_order.begin(), network_order.end(), address.bytes.begin());
  return address;
}

IpAddress IpAddress::v6_from(std::span<const std::uint8_t, 16> network_order) {
  constexpr std::array<std::uint8_t, 12> mapped{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff};
  if (std::equal(mapped.begin(), mapped.end(), network_order.begin()))
    return v4_from(network_order.last<4>());
  IpAddress address;
  address.v6 = true;
  std::copy(network_order.begin(), network_order.end(), address.bytes.begin());
  return address;
}

std::string IpAddress::text() const {
  char buffer[INET6_ADDRSTRLEN] = {};
  inet_ntop(v6 ? AF_INET6 : AF_INET, bytes.data(), buffer, sizeof buffer);
  return buffer;
}

std::optional<IpAddress> parse_ip_address(std::string_view text) {
  if (text.size() >= 2 && text.front() == '[' && text.back() == ']') text = text.substr(1, text.size() - 2);
  const std::string host(text.substr(0, text.find('%')));
  std::array<std::uint8_t, 16> bytes{};
  if (inet_pton(AF_INET, host.c_str(), bytes.data()) == 1) {
    return IpAddress::v4_from(std::span(bytes).first<4>());
  }
  if (inet_pton(AF_INET6, host.c_str(), bytes.data()) == 1) return IpAddress::v6_from(bytes);
  return std::nullopt;
}

std::string_view AddressText::of(const IpAddress& address) {
  if (address_ != address) {
    address_ = address;
    text_ = address.text();
  }
  return text_;
}

}  // namespace ca2
