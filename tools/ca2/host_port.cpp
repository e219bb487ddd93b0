#include "tools/ca2/host_port.h"

namespace ca2 {

Result<HostPort> parse_host_port(const std::string& text) {
  HostPort out{text, 0};
  const std::size_t colon = text.rfind(':');
  const bool bracketed = !text.empty() && text.front() == '[';
  const bool bare_v6 = !bracketed && text.find(':') != colon;
  if (colon != std::string::npos && !bare_v6 && (!bracketed || text[colon - 1] == ']')) {
    const std::string digits = text.substr(colon + 1);
    const bool number =
        !digits.empty() && digits.size() <= 5 && digits.find_first_not_of("0123456789") == std::string::npos;
    if (!number || std::stoi(digits) < 1 || std::stoi(digits) > 65535) {
      return fail(ErrorCode::usage, "", "'" + text + "' has no port from 1 to 65535 behind the colon");
    }
    out.port = static_cast<std::uint16_t>(std::stoi(digits));
    out.host = text.substr(0, colon);
  }
  if (bracketed && out.host.back() == ']') {
    out.host = out.host.substr(1, out.host.size() - 2);
  }
  return out;
}

}  // namespace ca2
