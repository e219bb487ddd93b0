/// @file An Ouster packet, from bytes: what it is and what its header says. Pure.
#pragma once

#include <cstdint>
#include <span>

#include "drivers/lidar/bytes.h"
#include "drivers/lidar/ouster/metadata.h"
#include "drivers/lidar/ouster/profile.h"

namespace ca2 {

/// Where everything lies in the packets of one sensor as it is configured now.
struct OusterFormat {
  const OusterProfile* profile = nullptr;  ///< nullptr: the sensor sends no lidar packets
  bool fusa_header = false;
  int pixels = 0;   ///< per column
  int columns = 0;  ///< per packet
  int frame_columns = 0;
  std::size_t column_bytes = 0;
  std::size_t packet_bytes = 0;
  std::size_t imu_bytes = 0;

  const std::uint8_t* column(const std::uint8_t* packet, int index) const {
    return packet + profile->packet_header() + static_cast<std::size_t>(index) * column_bytes;
  }
  const std::uint8_t* pixel(const std::uint8_t* column, int row) const {
    return column + profile->column_header() + static_cast<std::size_t>(row) * profile->pixel_bytes;
  }
  std::uint16_t measurement_id(const std::uint8_t* column) const { return load<std::uint16_t>(column + 8); }
  std::uint64_t timestamp(const std::uint8_t* column) const { return load<std::uint64_t>(column); }
  bool valid(const std::uint8_t* column) const {
    return (column[profile->legacy() ? column_bytes - 4 : 10] & 1) != 0;
  }
  /// Of frame ids, which wrap: 65536, or 2^32 with the functional safety header.
  std::int64_t frame_modulus() const { return fusa_header ? std::int64_t{1} << 32 : 65536; }
};

OusterFormat make_ouster_format(const OusterMetadata& metadata);

enum class OusterPacketKind { lidar, imu, zone, wrong_size, wrong_type };

/// Told by size and type byte; only `lidar` may be read further with OusterFormat.
OusterPacketKind classify_ouster_packet(const OusterFormat& format, std::span<const std::uint8_t> packet);

/// Zeros with the LEGACY profile, which has no packet header.
struct OusterPacketHeader {
  std::uint32_t frame_id = 0;
  std::uint32_t init_id = 0;
  std::uint64_t serial = 0;
};
OusterPacketHeader read_ouster_header(const OusterFormat& format, std::span<const std::uint8_t> packet);

/// False only for a checksum that is there and wrong: firmware before 2.5 and functional safety packets
/// carry a constant instead, LEGACY packets nothing.
bool ouster_checksum_fits(const OusterFormat& format, std::span<const std::uint8_t> packet);

}  // namespace ca2
