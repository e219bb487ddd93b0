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

namespace ca2 {

/// Which returns lie on the board changes only near its rim and near the gate. All others are summed up once
/// per place of the board ("settled"); a move costs what the few others ("open") cost, and gives to rounding
/// what summing everything again would.
class ReturnPatch {
 public:
  explicit ReturnPatch(const LidarSight& sight);

  /// Chooses the returns whose rays meet the plate at least `margin` [m] inside its rim, as the plate lies at
  /// T_lidar_board. `bias` and `gate` [m] are about what the sums will be asked for.
  /// True where the board moved so far that all returns were looked at again.
  bool aim(const Outline& outline, const Pose& T_lidar_board, double margin, double bias, double gate);
  /// Chooses the returns that the finder held for the board and gives the plane that fits them best, found
  /// from `plane`: those within `gate` [m] of it take part, and make the `sums`.
  Plane fit_found(const Plane& plane, double gate, RangeSums* sums = nullptr);

  /// Returns chosen, whatever their residuals.
  std::size_t count() const { return chosen_; }
  /// The highest ring of the chosen returns, -1 without any; nothing where some return's is not known.
  std::optional<int> highest_ring() const;
  /// From now on sums are by these classes, the returns being where they were last aimed at.
  void classify(const RangeClasses& classes, const InkMap& ink);
  /// Sums up what is settled, if that changed. To be called before what follows.
  void sum_up();

  /// The plane that fits the chosen returns best in the least-squares sense, from `plane`, those within
  /// `gate` [m] of it, their ranges corrected. `sums`, where given, are those about it.
  Plane fit_plane(const Plane& plane, double gate, const RangeCorrection& correction,
                  RangeSums* sums = nullptr) const;
  /// The sums of the chosen returns that are within `gate` [m] of `plane` and the bias; linearised at the
  /// place last aimed at, or close to it.
  RangeSums sums(const Plane& plane, double bias, double gate, const RangeCorrection& correction) const;
  /// What corrections are found from, over the chosen returns within `gate` [m] of `plane`.
  CorrectionEvidence evidence(const Plane& plane, double gate) const;

 private:
  struct Return {
    Eigen::Vector3f ray;  ///< unit
    float height;         ///< m, where on the z axis the ray begins
    double range;         ///< m, along the ray
    double predicted;     ///< m, to the reference plane
    std::uint16_t ring;
    std::uint16_t of_class;
    bool on_board;

    /// m along the ray to the plane q, see `inverse_plane`; not positive or NaN: it does not meet it.
    double predict(const Eigen::Vector3d& q) const;
    /// The place this far along the ray.
    Eigen::Vector3d at(double along) const;
  };
  struct Open {
    std::size_t index;
    bool chosen;
  };
  /// Where the settled sums are good.
  struct Place {
    Outline outline;
    Pose T_lidar_board;
    double bias = 0;   ///< the settled residuals lie about this, m
    double limit = 0;  ///< no further than this, m
  };

  bool holds(const Place& place) const;
  void settle_found(const Plane& plane, double gate);
  /// How much further along the rays than the reference plane this one is, at most, m.
  double move_to(const Eigen::Vector3d& q) const;
  void settle(const Place& place, double margin);
  void add(const Return& here, CorrectionEvidence& to) const;
  /// Everything chosen within the gate.
  CorrectionEvidence gather(const Eigen::Vector3d& q, double bias, double gate,
                            const RangeCorrection& correction) const;
  RangeSums sums_of(const CorrectionEvidence& all, const RangeCorrection& correction) const;

  std::vector<Return> returns_;  ///< the near ones first
  std::size_t near_ = 0;         ///< how many of them may meet the plate close to `near_pose_`
  Pose near_pose_;

  std::optional<Place> place_;
  Eigen::Vector3d reference_ = Eigen::Vector3d::Zero();
  std::array<Eigen::Vector3d, 4> rim_;  ///< unit rays about the settled returns
  double spread_ = 0;                   ///< of the settled residuals about the place's bias, m
  std::size_t chosen_ = 0;
  std::vector<std::size_t> settled_;
  std::vector<Open> open_;
  CorrectionEvidence sums_;  ///< of the settled
  bool stale_ = true;        ///< they are not of those
};

}  // namespace ca2
