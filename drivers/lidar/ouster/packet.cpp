#include "drivers/lidar/ouster/packet.h"

#include "drivers/lidar/crc64.h"

namespace ca2 {
namespace {

constexpr std::size_t legacy_imu_bytes = 48;
constexpr std::size_t zone_bytes = 680;
constexpr int type_lidar = 1, type_imu = 2, type_zone = 3;

}  // namespace

OusterFormat make_ouster_format(const OusterMetadata& metadata) {
  OusterFormat out;
  out.profile = find_ouster_profile(metadata.profile);
  out.fusa_header = metadata.fusa_header;
  out.pixels = metadata.pixels_per_column;
  out.columns = metadata.columns_per_packet;
  out.frame_columns = metadata.columns_per_frame;
  if (out.profile) {
    out.column_bytes = static_cast<std::size_t>(out.profile->column_header() + out.profile->column_footer() +
                                                out.pixels * out.profile->pixel_bytes);
    out.packet_bytes = static_cast<std::size_t>(out.profile->packet_header() + out.profile->packet_footer()) +
                       static_cast<std::size_t>(out.columns) * out.column_bytes;
  }
  // The newer IMU packet: header, 100 bytes about NMEA, 36 per measurement, footer.
  out.imu_bytes = metadata.imu_profile == "LEGACY"
                      ? legacy_imu_bytes
                      : 32 + 100 + 36 * static_cast<std::size_t>(metadata.imu_per_packet) + 32;
  return out;
}

OusterPacketKind classify_ouster_packet(const OusterFormat& format, std::span<const std::uint8_t> packet) {
  const bool typed = packet.size() >= 64;
  const int type = !typed ? 0 : format.fusa_header ? packet[0] : load<std::uint16_t>(packet.data());
  if (format.profile && packet.size() == format.packet_bytes) {
    // Sizes of different formats collide, so the type must fit as well.
    if (format.profile->legacy() || type == type_lidar) return OusterPacketKind::lidar;
  }
  if (packet.size() == legacy_imu_bytes) return OusterPacketKind::imu;
  const int other_type = typed ? packet[0] : 0;  // of either header
  if (packet.size() == format.imu_bytes && other_type == type_imu) return OusterPacketKind::imu;
  if (packet.size() == zone_bytes && other_type == type_zone) return OusterPacketKind::zone;
  const bool known_size = format.profile && packet.size() == format.packet_bytes;
  return known_size ? OusterPacketKind::wrong_type : OusterPacketKind::wrong_size;
}

OusterPacketHeader read_ouster_header(const OusterFormat& format, std::span<const std::uint8_t> packet) {
  const std::uint8_t* bytes = packet.data();
  OusterPacketHeader out;
  if (format.profile->legacy()) {
    out.frame_id = load<std::uint16_t>(bytes + 10);  // of the first column
  } else if (format.fusa_header) {
    out.init_id = static_cast<std::uint32_t>(load_bytes(bytes + 1, 3));
    out.frame_id = load<std::uint32_t>(bytes + 4);
    out.serial = load_bytes(bytes + 11, 5);
  } else {
    out.frame_id = load<std::uint16_t>(bytes + 2);
    out.init_id = static_cast<std::uint32_t>(load_bytes(bytes + 4, 3));
    out.serial = load_bytes(bytes + 7, 5);
  }
  return out;
}

bool ouster_checksum_fits(const OusterFormat& format, std::span<const std::uint8_t> packet) {
  if (format.profile->legacy()) return true;
  constexpr std::uint64_t absent = 0xDEADBEEF0000C0DEu;
  const std::size_t size = packet.size() - 8;
  const auto written = load<std::uint64_t>(packet.data() + size);
  return written == 0 || written == absent || written == crc64(packet.first(size));
}

}  // namespace ca2
