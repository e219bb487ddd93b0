/// @file Velodyne distances to points: the manual's formula, with no trigonometry per point.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "drivers/lidar/lidar_scan.h"
#include "drivers/lidar/return_writer.h"
#include "drivers/lidar/velodyne/packet.h"

namespace ca2 {

namespace detail {
struct VelodyneBlockPlace;
}  // namespace detail

/// With D = distance + correction, a = azimuth of the head at the laser's own firing time - its rotation:
///   x = D cos w sin a - h cos a,  y = D cos w cos a + h sin a,  z = D sin w + v
/// which is what VeloView computes (vertical offsets along z, not across the beam). The azimuth of the head
/// is interpolated at each laser's time and not rounded to 0.01 degree.
class VelodyneProjection {
 public:
  VelodyneProjection(const VelodyneModel& model, const VelodyneCalibration& calibration, bool two_point);

  /// Seconds from firing to firing, where the model's are not what the packets show.
  void set_cycle(double cycle);

  /// Says what will be projected: the table of all azimuths does not stay in the processor's near caches.
  void fetch(const VelodyneFirings& firings) const;

  /// Adds the returns of a firing, and their exact places where `exact` is not nullptr. Order: by bank, then
  /// the firing of its block, then return, then laser. `time`: ns of the packet's first firing. The firing's
  /// `step` of 0 leaves all lasers at the block's azimuth.
  void project(const VelodyneFiring& firing, std::int64_t time, std::uint32_t column, bool second_returns,
               ReturnWriter& out, std::vector<ExactReturn>* exact);

  int rings() const { return lasers_; }

  /// By channel of a block.
  using Lanes = std::array<float, VelodynePacket::channels>;
  /// What does not change with the head, in single precision.
  struct Bank {
    Lanes cos_vertical{}, sin_vertical{}, distance{}, vertical_offset{}, horizontal_offset{};
    Lanes focal{}, focal_slope{}, min_intensity{}, max_intensity{};  ///< focal: 256 (1 - distance / 131 m)^2
  };
  /// A block as it came.
  struct Block {
    std::array<std::uint32_t, VelodynePacket::channels> counts;
    std::array<std::uint8_t, VelodynePacket::channels> intensity;
  };
  /// Sine and cosine of the lasers' azimuths relative to their block's.
  struct Turned {
    Lanes sine{}, cosine{};
  };

 private:
  /// For one step of the azimuth, by bank. The steps of a spinning head are a handful of numbers, so
  /// the last ones are kept.
  struct Motion {
    double step = 0;
    bool rounded = false;
    std::vector<Turned> turned;
  };

  /// One return of a bank.
  struct Returns {
    Block block;
    int azimuth = 0;  ///< as VelodyneFiring
    double step = 0;
    FiredBeams beams;
  };

  double turned(std::size_t laser, double step, bool rounded, int half) const;
  const Motion& motion(double step, bool rounded);
  detail::VelodyneBlockPlace place_of(int azimuth, double step, std::size_t bank, bool rounded);
  ExactReturn exact_return(std::size_t laser, const Returns& returns, bool rounded, int half,
                           std::uint32_t counts) const;
  /// The places of a firing again, in double precision: for `exact`, and where near points are corrected.
  void add_exact(Returns& returns, std::size_t bank, bool rounded, int half,
                 std::vector<ExactReturn>* exact) const;

  VelodyneCalibration calibration_;
  std::vector<double> firing_;  ///< by laser, in cycles after the firing's start
  std::vector<Bank> banks_;
  std::vector<std::uint16_t> ring_;  ///< by laser
  std::vector<std::int32_t> delay_;  ///< by laser, ns after the firing's start

  double lsb_;     ///< m per count
  int per_block_;  ///< firings to a block
  int lasers_;
  int fired_;                            ///< lasers of a bank
  const std::pair<float, float>* head_;  ///< sine and cosine of every azimuth the wire can carry
  bool sideways_ = false;                ///< some laser has a horizontal offset
  bool two_point_ = false, corrected_intensity_ = false;
  bool at_once_ = false;  ///< blocks of one return are read, projected and written in one step
  double cycle_ = 0;      ///< s
  std::array<std::int64_t, 2 * VelodyneFirings::most> after_cycles_{};  ///< ns, by number of cycles
  std::array<Motion, 64> motions_;                                      ///< by a hash of the step
  std::size_t last_motion_ = 0;
  std::array<Returns, 2> returns_;
};

}  // namespace ca2
