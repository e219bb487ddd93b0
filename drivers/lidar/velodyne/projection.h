/// @file Velodyne distances to points: the manual's formula, with no trigonometry per point.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "drivers/lidar/lidar_scan.h"
#include "drivers/lidar/velodyne/packet.h"

namespace ca2 {

/// Returns of a packet, gathered before they are appended to a scan.
struct VelodyneReturns {
  static constexpr std::size_t capacity =
      static_cast<std::size_t>(VelodynePacket::blocks) * VelodynePacket::channels;
  std::array<Eigen::Vector3f, capacity> points;
  std::array<float, capacity> intensity, range;
  std::array<std::uint16_t, capacity> ring;
  std::array<std::uint32_t, capacity> column;
  std::array<std::int64_t, capacity> time;
  std::array<ExactReturn, capacity> exact;
  std::size_t size = 0;

  /// Appends all, and is empty.
  void append_to(LidarScan& out, bool with_exact);
};

/// With D = distance + correction, a = azimuth of the head at the laser's own firing time - its rotation:
///   x = D cos w sin a - h cos a,  y = D cos w cos a + h sin a,  z = D sin w + v
/// which is what VeloView computes (vertical offsets along z, not across the beam). The azimuth of the head
/// is interpolated at each laser's time and not rounded to 0.01 degree. Computed in double.
class VelodyneProjection {
 public:
  VelodyneProjection(const VelodyneModel& model, const VelodyneCalibration& calibration, bool two_point);

  /// Seconds from firing to firing, where the model's are not what the packets show.
  void set_cycle(double cycle);

  /// Adds the returns of a firing to `out`. `time`: ns of the packet's first firing. The firing's `step` of 0
  /// leaves all lasers at the block's azimuth.
  void project(const VelodyneFiring& firing, std::int64_t time, std::uint32_t column, bool second_returns,
               VelodyneReturns& out);

  /// Fills VelodyneReturns::exact too.
  void want_exact(bool wanted) { exact_ = wanted; }

  int rings() const { return static_cast<int>(ring_.size()); }

 private:
  /// Numbers of the lasers of one bank.
  using Lanes = Eigen::Array<double, Eigen::Dynamic, 1, 0, VelodynePacket::channels, 1>;
  /// The returns in a block.
  struct BlockReturns {
    Lanes counts, range, x, y, z, intensity;
  };
  /// Sine and cosine of the lasers' azimuths relative to the block's, at one step of the azimuth, by half and
  /// laser. The steps of a spinning head are a handful of numbers, so the last ones are kept.
  struct Motion {
    double step = 0;
    Eigen::ArrayXd sine[2], cosine[2];
  };

  const Motion& motion(double step);
  void project_block(const std::uint8_t* block, int bank, const VelodyneFiring& firing, BlockReturns& out);
  void correct_near(int first, const Lanes& sine, const Lanes& cosine, BlockReturns& out) const;

  // By laser.
  Eigen::ArrayXd cos_vertical_, sin_vertical_;
  Eigen::ArrayXd cos_rotation_, sin_rotation_;                     ///< of minus the rotation
  Eigen::ArrayXd distance_, vertical_offset_, horizontal_offset_;  ///< m
  Eigen::ArrayXd near_x_, near_y_;      ///< m, distance corrections at the near points
  Eigen::ArrayXd firing_;               ///< in cycles after the firing's start
  Eigen::ArrayXd focal_, focal_slope_;  ///< focal: 256 (1 - focal distance / 131 m)^2
  Eigen::ArrayXd min_intensity_, max_intensity_;
  std::vector<std::uint16_t> ring_;
  std::vector<std::int64_t> firing_time_;  ///< ns after the firing's start

  double lsb_;             ///< m per count
  int per_block_;          ///< firings to a block
  bool sideways_ = false;  ///< some laser has a horizontal offset
  bool exact_ = false, two_point_ = false, corrected_intensity_ = false;
  double cycle_ = 0;                ///< s
  std::array<Motion, 64> motions_;  ///< by a hash of the step
  BlockReturns returns_[2];         ///< of the block, or pair of blocks, in hand
};

}  // namespace ca2
