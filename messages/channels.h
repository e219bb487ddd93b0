/// @file LCM channels and the default provider.
#pragma once

namespace ca2::channel {

inline constexpr const char* status = "CA2_STATUS";
inline constexpr const char* view = "CA2_VIEW";
inline constexpr const char* extrinsics = "CA2_EXTRINSICS";
inline constexpr const char* preview = "CA2_PREVIEW";
inline constexpr const char* command = "CA2_COMMAND";
inline constexpr const char* reply = "CA2_REPLY";

}  // namespace ca2::channel

namespace ca2 {

/// ttl=0 keeps it on the host.
inline constexpr const char* default_lcm_url = "udpm://239.255.76.67:7667?ttl=0";

}  // namespace ca2
