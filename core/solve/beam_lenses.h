/// @file Beams that begin in a lens before the LiDAR's axis, where the points leave that out.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/camera/camera_model.h"
#include "core/features/sights.h"
#include "core/session/rig.h"
#include "core/solve/joint_solver.h"
#include "core/solve/rig_seed.h"

namespace ca2 {

/// Which points of a LiDAR the answer was made with.
struct LensVerdict {
  bool taken = false;    ///< points of beams that begin in the lens, `radius` before the axis; else as stated
  double radius = 0;     ///< m
  double doubt = 0;      ///< how probable the other ones are, 0 .. 0.5
  bool decided() const;  ///< the other ones are out of the question
};

struct LensedAnswer {
  JointAnswer answer;
  std::vector<LensVerdict> lenses;  ///< by LiDAR; radius 0: there was nothing to ask
};

/// solve_joint with the points that the views make more probable, where a model's manual speaks of a lens
/// (the rig names it, or names none and the beams are that model's) and the points leave it out: as stated,
/// or of beams that begin in it. The same points of a plane lie on no plane, or on another one, when they
/// were computed with the wrong beams: four views tell as a rule. Where they do not, the covariance has what
/// the answer would move by.
LensedAnswer solve_with_lenses(const Rig& rig, const std::vector<Camera>& cameras,
                               const std::vector<ViewSights>& views, const RigSeed& seed,
                               JointOptions options);

/// What a person should know of it; empty: nothing.
std::string lens_note(const std::string& lidar, const LensVerdict& lens);

/// Of LiDAR `lidar` of all views: do its returns' rays begin at the frame's origin rather than where those of
/// a lens meet the axis? What a scan shows of it is only known to a millimetre.
bool leaves_lens_out(const std::vector<ViewSights>& views, std::size_t lidar, double radius);

/// The views as LiDAR `lidar` would have seen them had its points been computed with that lens.
std::vector<ViewSights> through_lens(std::vector<ViewSights> views, std::size_t lidar, double radius);

/// How much more probable `second`'s planes are than `first`'s, logarithm; of the views that both use. Both
/// as JointAnswer::plane_misfits.
double planes_gain(const std::vector<Misfit>& first, const std::vector<Misfit>& second);

}  // namespace ca2
