/// @file Ranges into wire packets: what a simulator sends and recordings are made of. The inverse of the
/// decoders, up to the rounding of the wire format.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "drivers/lidar/beam_table.h"
#include "drivers/lidar/ouster/metadata.h"
#include "drivers/lidar/velodyne/velodyne_model.h"

namespace ca2 {

/// One revolution as a sensor measured it, on the grid of its BeamTable.
struct EncoderScan {
  int rings = 0;    ///< as BeamTable
  int columns = 0;  ///< as BeamTable
  /// m along the beam, [ring * columns + column]; 0: no return. The second array, of the second return of
  /// dual modes, may be empty.
  std::array<std::vector<float>, 2> range;
  std::array<std::vector<float>, 2> reflectivity;  ///< 0 to 255; empty: 100 throughout
  std::int64_t start = 0;      ///< ns: time of column 0 on the sensor's clock (Velodyne: UTC)
  std::uint32_t frame_id = 0;  ///< Ouster
  double azimuth = 0;  ///< Velodyne, turns: the head at column 0; its firings are not locked to its encoder
};

/// A datagram to be sent.
struct EncodedPacket {
  std::int64_t time = 0;  ///< ns, when the packet's last column was measured: when a sensor sends it
  std::vector<std::uint8_t> bytes;
};

/// True packets of the metadata's profile, with header and CRC; columns outside the window are not sent, or
/// marked invalid in a packet that has others.
std::vector<EncodedPacket> encode_ouster(const OusterMetadata& metadata, const EncoderScan& scan);

/// How a Velodyne is set up.
struct VelodyneEncoding {
  std::uint8_t return_mode = 0x37;  ///< 0x37 strongest, 0x38 last, 0x39 dual
  std::uint8_t product_id = 0;      ///< 0: the model's first
  double rate = 10;                 ///< rev/s
};

/// Packets of whole revolutions in a row: a packet does not end with a revolution, so scans are pushed one
/// after another and the remainder is kept. The range of a ring and column is that of the BeamTable's ray.
class VelodyneEncoder {
 public:
  VelodyneEncoder(const VelodyneModel& model, const VelodyneCalibration& calibration,
                  const VelodyneEncoding& encoding);

  std::vector<EncodedPacket> push(const EncoderScan& scan);
  /// What is left, filled up with blocks without returns.
  std::vector<EncodedPacket> flush();

 private:
  /// Returns of all lasers at one firing, [return][laser].
  struct Firing {
    std::int64_t time = 0;  ///< ns
    double azimuth = 0;     ///< turns
    std::array<std::vector<std::uint16_t>, 2> counts;
    std::array<std::vector<std::uint8_t>, 2> intensity;
  };

  Firing make_firing(const EncoderScan& scan, int column) const;
  EncodedPacket make_packet(const std::vector<Firing>& firings) const;
  void write_block(std::uint8_t* block, const Firing& firing, const Firing* second_half, int bank,
                   int ret) const;
  int firings_per_packet() const;

  VelodyneModel model_;
  VelodyneCalibration calibration_;
  VelodyneEncoding encoding_;
  std::vector<int> rings_;
  std::vector<Firing> waiting_;
};

}  // namespace ca2
