/// @file A Velodyne's position packet: whether its clock is locked to UTC, and where its GPS receiver is.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace ca2 {

enum class VelodynePps : std::uint8_t { absent, synchronizing, locked, error };

struct VelodynePosition {
  std::uint32_t us_of_hour = 0;
  VelodynePps pps = VelodynePps::absent;
  std::string nmea;     ///< the sentence, "$GPRMC,...*hh", empty where there is none or its checksum is wrong
  bool valid = false;   ///< of the sentence: the receiver has a fix
  double latitude = 0;  ///< deg, north positive; of an RMC sentence
  double longitude = 0;  ///< deg, east positive
  std::int64_t utc = 0;  ///< ns UTC that an RMC sentence says; 0: not known
};

/// Nothing when it is not 512 bytes long.
std::optional<VelodynePosition> parse_velodyne_position(std::span<const std::uint8_t> packet);

}  // namespace ca2
