/// @file Where the ends of a plate's side are, by rays of which a few may be stray ones.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace ca2 {

/// A ray's word on the angles (u, v) of a rim's ends: weights.(u, v) <= bound, rad.
struct RimRay {
  Eigen::Vector2d weights;
  double bound = 0;
  double slip = 0;  ///< rad: by so much the bound is further out when this is a stray ray
};

/// What the ends are looked for in, rad: within `reach` of `middle`, each ray trusted to within `blur`.
struct EndSearch {
  double middle = 0, reach = 0, blur = 0;
  double stray_share = 0;  ///< the chance of a ray not to be what it seems
};

struct RimEnds {
  Eigen::Vector2d mean;        ///< rad
  Eigen::Matrix2d covariance;  ///< rad^2
  double blur = 0;             ///< rad: by how much the rays contradict each other beyond the search's blur
};

/// Mean and covariance of the ends, any that all rays leave possible being as likely. A ray may not be what
/// it seems: the plate's last return got lost. Then it speaks of the gap beside its own. Where far more is
/// possible that way it is taken for that, the other rays keep their chance of it; rays that contradict the
/// others even so are left out. Rays that contradict each other beyond that are trusted to within a blur that
/// resolves it; nothing where none of 6.4 mrad does.
std::optional<RimEnds> find_rim_ends(std::vector<RimRay> rays, EndSearch search);

}  // namespace ca2
