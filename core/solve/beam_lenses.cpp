#include "core/solve/beam_lenses.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/lidar/beam_lens.h"
#include "core/solve/lens_evidence.h"
#include "core/types/text.h"

namespace ca2 {
namespace {

/// Less probable than this is out of the question.
constexpr double least_doubt = 0.01;
/// So many views mostly tell; where they do not (units of half chi-squared, of which fewer views than those
/// of the answer could explain a few), all are asked.
constexpr std::size_t enough_views_to_tell = 24;
constexpr double beyond_question = 20;
/// Returns that show a LiDAR's beams: hundreds in each of its rings.
constexpr std::size_t enough_to_tell = 4000;

/// The views with the lenses of those LiDARs, and of `l` the other way round where that is one of them.
std::vector<ViewSights> seen_through(std::vector<ViewSights> views, const std::vector<LensVerdict>& lenses,
                                     std::size_t other_way) {
  for (std::size_t l = 0; l < lenses.size(); ++l) {
    if (lenses[l].taken != (l == other_way)) views = through_lens(std::move(views), l, lenses[l].radius);
  }
  return views;
}
constexpr std::size_t none = static_cast<std::size_t>(-1);

/// The radius to ask for; 0: nothing to ask. What a rig calls a LiDAR is what it is.
double lens_to_ask_for(const RigLidar& lidar, const std::vector<ViewSights>& views, std::size_t l) {
  if (!lidar.model.empty()) return beam_lens_radius(lidar.model);
  if (!lidar.metadata.empty()) return 0;  // an Ouster
  std::vector<const std::vector<BoardReturn>*> lists;
  std::size_t count = 0;
  for (const ViewSights& view : views) {
    for (const LidarSight& sight : view.lidars[l]) {
      for (const auto* returns : {&sight.on_board, &sight.around}) {
        lists.push_back(returns);
        count += returns->size();
      }
    }
  }
  const std::size_t step = 1 + count / enough_to_tell;
  std::vector<float> elevations;
  std::size_t next = 0;  // from the beginning of a list
  for (const std::vector<BoardReturn>* list : lists) {
    for (; next < list->size(); next += step) {
      const Eigen::Vector3f& point = (*list)[next].point;
      elevations.push_back(std::atan2(point.z(), point.head<2>().norm()));
    }
    next -= list->size();
  }
  return beam_lens_radius(elevations);
}

/// The views of which nothing is left but those in use, or about `most` of them, evenly.
std::vector<ViewSights> some_used(const std::vector<ViewSights>& views,
                                  const std::vector<JointViewOutcome>& outcomes, std::size_t most) {
  const auto used = static_cast<std::size_t>(std::ranges::count_if(outcomes, &JointViewOutcome::used));
  const std::size_t step = 1 + (used - std::min<std::size_t>(used, 1)) / most;
  std::vector<ViewSights> some;
  std::size_t count = 0;
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (outcomes[v].used && count++ % step == 0) {
      some.push_back(views[v]);
      continue;
    }
    ViewSights& nothing = some.emplace_back();
    nothing.id = views[v].id;
    nothing.cameras.resize(views[v].cameras.size());
    nothing.lidars.resize(views[v].lidars.size());
  }
  return some;
}

/// Widens the covariance by where LiDAR `l` is with probability `chance`.
void admit(JointAnswer& answer, const JointAnswer& other, std::size_t l, double chance) {
  if (!answer.covariance.allFinite()) return;
  const Vector6d move = answer.state.T_ref_lidar[l].difference(other.state.T_ref_lidar[l]);
  const auto i = static_cast<Eigen::Index>(6 * (answer.state.T_ref_camera.size() - 1 + l));
  answer.covariance.block<6, 6>(i, i) += chance * move * move.transpose();
}

}  // namespace

bool LensVerdict::decided() const {
  return doubt < least_doubt;
}

LensedAnswer solve_with_lenses(const Rig& rig, const std::vector<Camera>& cameras,
                               const std::vector<ViewSights>& views, const RigSeed& seed,
                               JointOptions options) {
  for (const auto& [name, lidar] : rig.lidars)
    options.lens_radius.push_back(lens_to_ask_for(lidar, views, options.lens_radius.size()));
  const std::size_t count = rig.lidars.size();
  // An answer that was stopped means nothing and may be empty: nothing is read from it.
  const auto stopped = [stop = options.stop] { return stop.stop_requested(); };
  const auto solved = [&](const std::vector<ViewSights>& seen) {
    return solve_joint(rig.board, cameras, static_cast<int>(count), seen, seed, options);
  };
  LensedAnswer found{solved(views), std::vector<LensVerdict>(count)};
  const std::vector<double> radii = std::exchange(options.lens_radius, {});
  const auto gain_of = [&](std::size_t l, std::size_t most) {
    const std::vector<ViewSights> asked =
        through_lens(some_used(views, found.answer.views, most), l, radii[l]);
    RigSeed of_asked = seed;
    for (std::size_t v = 0; v < asked.size(); ++v) {
      for (std::size_t i = 0; i < count; ++i)
        if (asked[v].lidars[i].empty()) of_asked.chosen[v][i] = -1;
    }
    return planes_gain(found.answer.plane_misfits,
                       plane_misfits(rig.board, cameras, static_cast<int>(count), asked, of_asked, options));
  };
  for (std::size_t l = 0; l < count && !stopped(); ++l) {
    if (!(radii[l] > 0) || !leaves_lens_out(views, l, radii[l])) continue;
    double gain = gain_of(l, enough_views_to_tell);
    if (std::abs(gain) < beyond_question && views.size() > enough_views_to_tell)
      gain = gain_of(l, views.size());
    if (!found.answer.lens_gain.empty()) gain += found.answer.lens_gain[l];
    found.lenses[l] = {gain > 0, radii[l], 1 / (1 + std::exp(std::abs(gain)))};
  }
  if (std::any_of(found.lenses.begin(), found.lenses.end(), [](const LensVerdict& l) { return l.taken; }))
    found.answer = solved(seen_through(views, found.lenses, none));
  for (std::size_t l = 0; l < count; ++l) {
    const LensVerdict& lens = found.lenses[l];
    if (!(lens.radius > 0) || lens.decided()) continue;
    const JointAnswer other = solved(seen_through(views, found.lenses, l));
    if (stopped()) break;
    admit(found.answer, other, l, lens.doubt);
  }
  return found;
}

std::string lens_note(const std::string& lidar, const LensVerdict& lens) {
  const double radius = 1e3 * lens.radius;  // mm
  if (lens.radius > 0 && !lens.decided()) {
    return formatted(
        "these views do not tell whether the beams of %s begin in its lens, %.0f mm before its axis, "
        "which its points leave out (%s, at %.0f %%): the sigmas include it; show the board higher and "
        "lower too",
        lidar.c_str(), radius, lens.taken ? "taken to be so" : "taken not to be so", 100 * (1 - lens.doubt));
  }
  if (!lens.taken) return {};
  return formatted(
      "the boards show that the beams of %s begin in its lens, %.0f mm before its axis, which its points "
      "leave out: it was taken into account; to draw its points exactly, move each by -%.1f mm times the "
      "tangent of its elevation along z",
      lidar.c_str(), radius, radius);
}

bool leaves_lens_out(const std::vector<ViewSights>& views, std::size_t lidar, double radius) {
  double as_stated = 0, by_lens = 0;  // m
  for (const ViewSights& view : views) {
    for (const LidarSight& sight : view.lidars[lidar]) {
      for (const BoardReturn& one : sight.on_board) {
        as_stated += std::abs(one.height);
        by_lens += std::abs(height_through_lens(one.point, radius));
      }
    }
  }
  return as_stated < 0.5 * by_lens;
}

std::vector<ViewSights> through_lens(std::vector<ViewSights> views, std::size_t lidar, double radius) {
  for (ViewSights& view : views) {
    for (LidarSight& sight : view.lidars[lidar]) {
      for (auto* returns : {&sight.on_board, &sight.around}) {
        for (BoardReturn& one : *returns) {
          const float height = height_through_lens(one.point, radius);
          one.point.z() += height - one.height;
          one.height = height;
        }
      }
      for (EdgeCrossing& crossing : sight.crossings) move_through_lens(crossing, radius);
    }
  }
  return views;
}

double planes_gain(const std::vector<Misfit>& first, const std::vector<Misfit>& second) {
  double one = 0, other = 0;
  int freedom = 0;
  for (std::size_t v = 0; v < first.size() && v < second.size(); ++v) {
    if (first[v].lidar_freedom <= 0 || second[v].lidar_freedom <= 0) continue;
    one += first[v].lidars;
    other += second[v].lidars;
    freedom += first[v].lidar_freedom;
  }
  // What neither explains says nothing.
  return 0.5 * (one - other) / std::max(1.0, std::min(one, other) / std::max(1, freedom));
}

}  // namespace ca2
