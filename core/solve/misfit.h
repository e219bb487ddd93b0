/// @file How far the sensors of a view disagree about the board, and whether chance explains it.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

namespace ca2 {

/// Disagreement about the board pose, as chi-squared with its degrees of freedom.
struct Misfit {
  double lidars = 0;   ///< of the LiDARs' planes with what the cameras together say
  double cameras = 0;  ///< of the cameras with each other
  int lidar_freedom = 0;
  int camera_freedom = 0;

  Misfit& operator+=(const Misfit& other);
};

/// By how much a misfit is larger than noise explains, as a factor on the variance; 1 where it may be chance.
double misfit_excess(double misfit, int freedom);

/// Do LiDARs and cameras disagree by more than chance?
bool lidars_disagree(const Misfit& misfit);

/// Does what was changed between both explain how LiDARs and cameras disagreed? Of what else may be wrong, as
/// the views' objects, hardly a part may go with it.
bool explains(const Misfit& before, const Misfit& after);

struct WorstView {
  std::size_t index = 0;
  std::string reason;  ///< for a person
};

/// The view that disagrees most, where it does so by more than one view in ten thousand would by chance;
/// where the views at large disagree by more than noise, that is the measure.
std::optional<WorstView> find_worst_view(std::span<const Misfit> views);

}  // namespace ca2
