/// @file The returns of one board patch, kept so that they can be summed again and again while the board
/// moves a little.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/board/board.h"
#include "core/board/ink_map.h"
#include "core/features/sights.h"
#include "core/geometry/pose.h"
#include "core/solve/range_correction.h"
#include "core/solve/range_sums.h"
#include "core/solve/return_lanes.h"

namespace ca2 {

/// Which returns lie on the board changes only near its rim and near the gate. All others are summed up once
/// per place of the board ("settled"); a move costs what the few others ("open") cost, and gives to a
/// micrometre or two what summing everything again would.
class ReturnPatch {
 public:
  /// `ink`: of the board's print, must live as long.
  ReturnPatch(const LidarSight& sight, const InkMap& ink);

  /// Chooses the returns whose rays meet the plate at least `margin` [m] inside its rim, as the plate lies at
  /// T_lidar_board. `bias` and `gate` [m] are about what the sums will be asked for.
  /// True where the board moved so far that all returns were looked at, and classified, again; nothing is
  /// corrected then.
  bool aim(const Outline& outline, const Pose& T_lidar_board, double margin, double bias, double gate);
  /// Chooses the returns that the finder held for the board and gives the plane that fits them best, found
  /// from `plane`: those within `gate` [m] of it take part, and make the `sums`.
  Plane fit_found(const Plane& plane, double gate, RangeSums* sums = nullptr);
  /// Takes out what ranges are off by.
  void correct(const RangeCorrection& correction);

  /// Returns chosen, whatever their residuals.
  std::size_t count() const { return chosen_; }
  /// The highest ring of the chosen returns, -1 without any; nothing where some return's is not known.
  std::optional<int> highest_ring() const;

  /// The plane that fits the chosen returns best in the least-squares sense, from `plane`, those within
  /// `gate` [m] of it. `sums`, where given, are those about it.
  Plane fit_plane(const Plane& plane, double gate, RangeSums* sums = nullptr) const;
  /// The sums of the chosen returns that are within `gate` [m] of `plane` and the bias; linearised at the
  /// place last aimed at, or close to it.
  RangeSums sums(const Plane& plane, double bias, double gate) const;
  /// What corrections are found from, over the chosen returns within `gate` [m] of `plane`, uncorrected.
  CorrectionEvidence evidence(const Plane& plane, double gate) const;

 private:
  /// Where the settled sums are good.
  struct Place {
    Outline outline;
    Pose T_lidar_board;
    double bias = 0;   ///< the settled residuals lie about this, m
    double limit = 0;  ///< no further than this, m
  };
  /// One return about the reference plane, see ClassSums.
  struct Linear {
    double r;
    Eigen::Vector4d J;
  };
  /// A return that is not settled, with what is asked of it again and again.
  struct Open {
    std::uint16_t of_class;
    bool chosen;
    double height, range;  ///< m
    double off;            ///< m: its range is to be corrected by so much
    Eigen::Vector3d ray;
    Linear linear;
  };
  /// Which returns take part.
  struct Pass {
    Eigen::Vector3d q;
    double bias, gate;
    bool corrected = true;  ///< judged by its corrected range
  };

  bool holds(const Place& place) const;
  void settle(const Place& place, double margin);
  void settle_found(const Plane& plane, double gate);
  /// Of a return by its ring and a bin of RangeClasses.
  std::uint16_t class_of(std::size_t index, int bin);
  Open opened(std::size_t index) const;
  void sum_up();  ///< the settled ones, uncorrected
  /// How much further along the rays than the reference plane this one is, at most, m.
  double move_to(const Eigen::Vector3d& q) const;

  /// Do the settled ones pass for certain?
  bool all_settled_pass(const Pass& pass) const;
  /// Calls add(Open) for the settled returns that pass, or only for the open ones.
  template <typename Add>
  void each_passing(const Pass& pass, bool settled, const Add& add) const;
  RangeSums sums_of(const Pass& pass) const;  ///< of all that pass

  const InkMap& ink_;
  ReturnArrays returns_;  ///< the finder's first
  std::size_t size_ = 0, found_ = 0;
  std::vector<std::uint16_t> ring_, of_class_;  ///< by return; rings from 1 on, 0: not known
  std::vector<int> slots_;                      ///< index of the class by ring and bin, -1: none yet
  Eigen::VectorXf predicted_;                   ///< m along the rays to the reference plane
  Eigen::VectorXf settled_;                     ///< 1: it is; 0: it is not

  std::optional<Place> place_;
  Eigen::Vector3d reference_ = Eigen::Vector3d::Zero();
  std::array<Eigen::Vector3d, 4> rim_;  ///< unit rays about the settled returns
  double spread_ = 0;                   ///< of the settled residuals about the place's bias, m
  std::size_t settled_count_ = 0, chosen_ = 0;
  std::vector<Open> open_;
  CorrectionEvidence sums_;  ///< of the settled
  RangeSums corrected_;      ///< the same, corrected
  std::vector<double> off_;  ///< m, by class: the correction
  double most_off_ = 0;      ///< m
};

}  // namespace ca2
