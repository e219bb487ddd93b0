/// @file Velodyne distances to points: the manual's formula, with no trigonometry per point.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "drivers/lidar/lidar_scan.h"
#include "drivers/lidar/velodyne/packet.h"

namespace ca2 {

/// Returns of one firing, gathered before they are appended to a scan.
struct VelodyneReturns {
  static constexpr std::size_t capacity = 256;
  std::array<Eigen::Vector3f, capacity> points;
  std::array<float, capacity> intensity, range;
  std::array<std::uint16_t, capacity> ring;
  std::array<std::int64_t, capacity> time;
  std::array<ExactReturn, capacity> exact;
  std::size_t size = 0;

  void append_to(LidarScan& out, std::uint32_t column, bool with_exact) const;
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

  /// Fills `out` with the returns of a firing. `time`: ns of the packet's first firing. The firing's `step`
  /// of 0 leaves all lasers at the block's azimuth.
  void project(const VelodyneFiring& firing, std::int64_t time, bool second_returns, VelodyneReturns& out);

  int rings() const { return static_cast<int>(lasers_.size()); }

 private:
  struct Laser {
    double cos_vertical, sin_vertical;
    double cos_rotation, sin_rotation;                    ///< of minus the rotation
    double distance, vertical_offset, horizontal_offset;  ///< m
    double firing;                                        ///< in cycles after the firing's start
    double focal, focal_slope;                            ///< focal: 256 (1 - focal distance / 131 m)^2
    float min_intensity, max_intensity;
    double near_x, near_y;  ///< m, correction to x at 2.40 m and y at 1.93 m
    bool two_point;
    std::uint16_t ring;
  };
  /// Sine and cosine of a laser's azimuth relative to the block's.
  struct Turn {
    double sine, cosine;
  };

  void project_one(const Laser& laser, const Turn& turn, const Turn& head, int counts, int intensity,
                   std::int64_t time, VelodyneReturns& out) const;

  std::vector<Laser> lasers_;
  double lsb_;
  bool corrected_intensity_ = false;
  double cycle_ = 0;
  std::vector<std::int64_t> firing_time_;  ///< ns after the firing's start, by laser

  /// Turns at one step of the azimuth, by half and laser. The steps of a spinning head are a handful of
  /// numbers, so the last ones are kept.
  struct Motion {
    double step = 0;
    std::vector<Turn> turns;
  };
  const Turn* turns(double step, int half);

  int per_block_;                   ///< firings to a block
  std::array<Motion, 64> motions_;  ///< by a hash of the step
};

}  // namespace ca2
