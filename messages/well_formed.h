/// @file Is this an LCM message of a type? To be asked before decoding what anybody may have sent: the code
/// that lcm-gen 1.3.1 makes believes every string's length, and reads where there is nothing.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace ca2 {

/// `layout` is the type's fields in order: b boolean or byte, i int32_t, q int64_t, d double, s string, and
/// in parentheses what is there as often as the int32_t before says. The fingerprint is left to decode().
bool well_formed(std::string_view layout, std::span<const std::uint8_t> message);

namespace layout {
inline constexpr std::string_view command_v1 = "qssqssbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbb";
inline constexpr std::string_view reply_v1 = "qssqsbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbb";
inline constexpr std::string_view status_v1 =
    "qqssssdbiii(sbsssbbdqqqqddd)sddddsbbssddddddddd"
    "ssqq";
}  // namespace layout

}  // namespace ca2
