#include <algorithm>
#include <cmath>

#include "drivers/lidar/crc64.h"
#include "drivers/lidar/encode.h"
#include "drivers/lidar/ouster/packet.h"

namespace ca2 {
namespace {

void write_field(const OusterField& field, std::uint8_t* pixel, double value) {
  if (!field.present()) return;
  const double largest = static_cast<double>((1u << field.width) - 1);
  const auto bits =
      static_cast<std::uint32_t>(std::clamp(std::round(value / (1 << field.shift)), 0.0, largest));
  // Byte by byte: a field of the last pixel must not touch what comes after it.
  for (int bit = 0; bit < field.width; ++bit) {
    const int at = field.bit + bit;
    if ((bits >> bit & 1u) != 0) pixel[at / 8] = static_cast<std::uint8_t>(pixel[at / 8] | 1u << at % 8);
  }
}

void write_header(const OusterFormat& format, const OusterMetadata& metadata, std::uint32_t frame_id,
                  std::uint8_t* bytes) {
  constexpr std::uint16_t lidar = 1;
  if (format.profile->legacy()) return;
  if (format.fusa_header) {
    bytes[0] = lidar;
    store_bytes(bytes + 1, metadata.init_id, 3);
    store(bytes + 4, frame_id);
    store_bytes(bytes + 11, metadata.serial, 5);
  } else {
    store(bytes, lidar);
    store(bytes + 2, static_cast<std::uint16_t>(frame_id));
    store_bytes(bytes + 4, metadata.init_id, 3);
    store_bytes(bytes + 7, metadata.serial, 5);
  }
}

void write_column(const OusterFormat& format, const EncoderScan& scan, int id, std::uint64_t time, bool valid,
                  std::uint8_t* column) {
  const OusterProfile& profile = *format.profile;
  store(column, time);
  store(column + 8, static_cast<std::uint16_t>(id));
  if (profile.legacy()) {
    constexpr std::uint32_t ticks = 90112;  // of the encoder, per revolution
    store(column + 10, static_cast<std::uint16_t>(scan.frame_id));
    store(column + 12, static_cast<std::uint32_t>(static_cast<std::uint64_t>(id) * ticks /
                                                  static_cast<std::uint64_t>(format.frame_columns)));
    store(column + format.column_bytes - 4, valid ? 0xFFFFFFFFu : 0u);
  } else {
    store(column + 10, static_cast<std::uint16_t>(valid ? 1 : 0));
  }
  if (!valid) return;
  for (int row = 0; row < format.pixels; ++row) {
    const std::size_t at = static_cast<std::size_t>(row) * scan.columns + id;
    std::uint8_t* pixel =
        column + profile.column_header() + static_cast<std::size_t>(row) * profile.pixel_bytes;
    for (int i = 0; i < 2; ++i) {
      if (scan.range[i].empty() || !(scan.range[i][at] > 0)) continue;
      const double reflectivity = scan.reflectivity[i].empty() ? 100 : scan.reflectivity[i][at];
      write_field(profile.range[i], pixel, scan.range[i][at] * 1000.0);
      write_field(profile.reflectivity[i], pixel, reflectivity);
      write_field(profile.signal[i], pixel, 10 * reflectivity);
    }
  }
}

}  // namespace

std::vector<EncodedPacket> encode_ouster(const OusterMetadata& metadata, const EncoderScan& scan) {
  const OusterFormat format = make_ouster_format(metadata);
  std::vector<EncodedPacket> packets;
  if (!format.profile || scan.rings != format.pixels || scan.columns != format.frame_columns) return packets;
  const double period = 1e9 / (metadata.rate * format.frame_columns);
  const auto time_of = [&](int id) { return scan.start + std::llround(id * period); };
  for (int first = 0; first < format.frame_columns; first += format.columns) {
    bool any = false;
    EncodedPacket packet;
    packet.bytes.resize(format.packet_bytes);
    write_header(format, metadata, scan.frame_id, packet.bytes.data());
    for (int i = 0; i < format.columns; ++i) {
      const int id = first + i;
      if (id >= format.frame_columns) break;
      const bool valid = metadata.in_window(id);
      any = any || valid;
      std::uint8_t* column = packet.bytes.data() + format.profile->packet_header() +
                             static_cast<std::size_t>(i) * format.column_bytes;
      write_column(format, scan, id, static_cast<std::uint64_t>(time_of(id)), valid, column);
    }
    if (!any) continue;
    if (!format.profile->legacy() && !format.fusa_header) {
      const std::size_t size = packet.bytes.size() - 8;
      store(packet.bytes.data() + size, crc64({packet.bytes.data(), size}));
    }
    packet.time = time_of(first + format.columns);
    packets.push_back(std::move(packet));
  }
  return packets;
}

}  // namespace ca2
