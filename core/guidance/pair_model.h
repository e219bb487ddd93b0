/// @file What a calibration tells of a camera, a LiDAR and the views they share.
#pragma once

#include <optional>
#include <vector>

#include "core/features/sights.h"
#include "core/guidance/view_information.h"
#include "core/session/calibration.h"
#include "core/session/rig.h"

namespace ca2 {

/// The rings of a LiDAR, as elevation above its x-y plane, rad.
struct ElevationRange {
  double low = -M_PI / 2, high = M_PI / 2;
};

struct PairModel {
  CalibratedTransform transform;
  SightModel model;
  std::vector<int> ids;                      ///< of the views in use that both sensors have
  std::vector<PairInformation> information;  ///< of each of them
  PairInformation prior;                     ///< what is known without any view
  double nearest = 0, farthest = 0;          ///< m, of the board from the LiDAR in these views
};

/// The camera-LiDAR pair whose sigmas are worst against the target, with its noise and density of returns as
/// the views show them. `lidars`: by index, in the rig's order; missing ones see everything. Nothing where no
/// pair has a view.
std::optional<PairModel> worst_pair_model(const Rig& rig, const Calibration& calibration,
                                          const std::vector<ViewSights>& views,
                                          const std::vector<ElevationRange>& lidars,
                                          const SigmaTarget& target);

/// Ids, rising, of the `count` views that determine that pair best (choose_views.h); all in use where there
/// are no more.
std::vector<int> best_views(const Rig& rig, const Calibration& calibration,
                            const std::vector<ViewSights>& views, std::size_t count,
                            const SigmaTarget& target);

}  // namespace ca2
