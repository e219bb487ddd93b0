#include "core/solve/rig_seed.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/solve/consensus.h"
#include "core/solve/half_turn.h"
#include "core/solve/rim_seed.h"
#include "core/solve/view_use.h"
#include "core/types/text.h"

namespace ca2 {
namespace {

/// So many returns of a patch tell its spread well enough.
constexpr std::size_t enough_returns = 200;

/// Why a sensor has no place: nothing is said of views agreeing where there are not three.
Problem no_place(const Board& board, const std::string& sensor, const std::string& reference,
                 std::size_t shared, const std::vector<ViewSights>& views) {
  if (shared >= 3)
    return {sensor, "no three views agree on where this sensor sits relative to " + reference,
            "show the board to both at once, at different tilts; check the board's size in the rig"};
  Problem problem{sensor,
                  formatted("this sensor and a camera see the board together in %zu of %zu views, and three "
                            "are the least that determine the answer",
                            shared, views.size()),
                  "show the board in more places, each at another tilt"};
  if (!board.outline) problem.hint += "; with the plate's `outline` in the rig even one view may do";
  for (const ViewSights& view : views) {
    if (view.problem.empty()) continue;
    problem.what += formatted(" (view %d: %s)", view.id, view.problem.c_str());
    break;
  }
  return problem;
}

/// Why a camera has no place where views are few.
Problem two_ways(const std::string& camera, const std::string& reference) {
  return {camera,
          "these views leave open how this camera sits relative to " + reference +
              ": they do not see the board together, or its pattern looks alike after half a turn",
          "show the board to both at once, in more places, each at another tilt; or give a first guess in "
          "`extrinsics`"};
}

/// Standard deviation of a patch normal about its worse axis, from the spread of its returns, rad.
double patch_normal_sigma(const LidarSight& sight) {
  if (sight.on_board.size() < 4) return 0.1;
  const std::size_t step = 1 + sight.on_board.size() / enough_returns;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  double count = 0;
  for (std::size_t i = 0; i < sight.on_board.size(); i += step) {
    const Eigen::Vector3d d = sight.on_board[i].point.cast<double>() - sight.center;
    sum += d;
    scatter.noalias() += d.lazyProduct(d.transpose());
    count += 1;
  }
  scatter -= sum * sum.transpose() / count;
  scatter *= static_cast<double>(sight.on_board.size()) / count;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(scatter);
  return std::clamp(sight.rms / std::sqrt(std::max(1e-12, eigen.eigenvalues()(1))), 1e-4, 0.1);
}

/// A LiDAR's hypotheses in one view.
std::vector<PatchPlane> patches_of(const std::vector<LidarSight>& sights) {
  std::vector<PatchPlane> patches;
  for (const LidarSight& sight : sights)
    patches.push_back({sight.plane, sight.center, patch_normal_sigma(sight)});
  return patches;
}

/// What the consensus needs to know of one view for a camera and a LiDAR, with the board's plate centre.
ConsensusView consensus_view(const Board& board, const CameraSight& camera,
                             const std::vector<PatchPlane>& patches) {
  ConsensusView view;
  view.camera = board_plane(camera.pose.T_camera_board);
  const Eigen::Vector2d center = board.extent().center;
  view.center = camera.pose.T_camera_board * Eigen::Vector3d(center.x(), center.y(), 0);
  const double tilt_variance =
      camera.pose.covariance.topLeftCorner<2, 2>().trace();  // about the board's x and y
  view.normal_sigma = std::clamp(std::sqrt(std::max(0.0, tilt_variance)), 1e-4, 0.1);
  view.patches = patches;
  return view;
}

/// Tolerances that follow from the board's size.
ConsensusOptions consensus_options(const Board& board, std::uint64_t seed, std::stop_token stop = {}) {
  ConsensusOptions options;
  options.board_radius = 0.5 * std::max(board.extent().width, board.extent().height);
  options.seed = seed;
  options.stop = std::move(stop);
  return options;
}

/// The link between two sensors that most views support.
struct Link {
  int a = 0, b = 0;  ///< sensors: cameras first
  Pose T_a_b;
  int support = 0;
};

/// Somebody's guess of T_a_b; nothing where there is none.
std::optional<Pose> guess_of(const std::vector<PlaceGuess>& guesses, int a, int b) {
  for (const PlaceGuess& guess : guesses) {
    if (guess.a == a && guess.b == b) return guess.T_a_b;
    if (guess.a == b && guess.b == a) return guess.T_a_b.inverse();
  }
  return std::nullopt;
}

/// One or two views may support two relative poses alike, half a turn apart: the guess says which is meant.
/// Nothing where there is none, or where it is near neither.
std::optional<Pose> told_by_guess(const std::vector<Pose>& alike, const std::optional<Pose>& guess) {
  constexpr double quarter = M_PI / 2;
  for (const Pose& pose : alike) {
    if (guess && guess->difference(pose).head<3>().norm() < quarter) return pose;
  }
  return std::nullopt;
}

/// Relative pose of two cameras from the board poses of shared views; half-turn ambiguity settled by the
/// largest group of views that agree; where the views are `few`, the guess may have to.
std::optional<Link> link_cameras(const Board& board, const std::vector<ViewSights>& views, int a, int b,
                                 bool few, const std::optional<Pose>& guess) {
  std::vector<Pose> proposals;
  std::vector<std::size_t> owner;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const auto& sight_a = views[v].cameras[static_cast<std::size_t>(a)];
    const auto& sight_b = views[v].cameras[static_cast<std::size_t>(b)];
    if (!sight_a || !sight_b) continue;
    proposals.push_back(sight_a->pose.T_camera_board * sight_b->pose.T_camera_board.inverse());
    owner.push_back(v);
    if (!board.type->half_turn_ambiguous(board)) continue;
    proposals.push_back(sight_a->pose.T_camera_board * half_turned(sight_b->pose.T_camera_board).inverse());
    owner.push_back(v);
  }
  Link best{a, b, {}, 0};
  std::vector<Pose> alike;  // as well supported, but not the same
  const std::size_t candidates = std::min<std::size_t>(proposals.size(), 60);
  for (std::size_t i = 0; i < candidates; ++i) {
    int support = 0;
    std::size_t last = views.size();
    for (std::size_t k = 0; k < proposals.size(); ++k) {
      const Vector6d d = proposals[i].difference(proposals[k]);
      if (owner[k] != last && d.head<3>().norm() < 0.05 && d.tail<3>().norm() < 0.1) {
        ++support;
        last = owner[k];
      }
    }
    if (support > best.support) {
      best = {a, b, proposals[i], support};
      alike = {proposals[i]};
    } else if (support == best.support && best.T_a_b.difference(proposals[i]).head<3>().norm() > 0.05) {
      alike.push_back(proposals[i]);
    }
  }
  if (best.support == 0) return std::nullopt;
  if (few && alike.size() > 1) {
    const std::optional<Pose> told = told_by_guess(alike, guess);
    if (!told) return std::nullopt;
    best.T_a_b = *told;
  }
  return best;
}

/// `patches`: of the LiDAR, by view.
std::optional<Link> link_lidar(const Board& board, const std::vector<ViewSights>& views,
                               const std::vector<std::vector<PatchPlane>>& patches, int camera, int lidar,
                               int cameras, std::uint64_t seed, std::stop_token stop) {
  std::vector<ConsensusView> pairs;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const auto& sight = views[v].cameras[static_cast<std::size_t>(camera)];
    if (sight && !patches[v].empty()) pairs.push_back(consensus_view(board, *sight, patches[v]));
  }
  const std::optional<Consensus> consensus =
      find_consensus(pairs, consensus_options(board, seed, std::move(stop)));
  if (!consensus) return std::nullopt;
  return Link{camera, cameras + lidar, consensus->T_camera_lidar, consensus->agreeing};
}

/// Where the sensors are: grown from the reference along the strongest link that reaches a new one.
std::vector<std::optional<Pose>> grow(std::vector<Link> links, std::size_t sensors) {
  std::stable_sort(links.begin(), links.end(),
                   [](const Link& x, const Link& y) { return x.support > y.support; });
  std::vector<std::optional<Pose>> T_ref_sensor(sensors);
  T_ref_sensor[0] = Pose{};
  for (bool grown = true; grown;) {
    grown = false;
    for (const Link& link : links) {
      auto& a = T_ref_sensor[static_cast<std::size_t>(link.a)];
      auto& b = T_ref_sensor[static_cast<std::size_t>(link.b)];
      if (a && !b)
        b = *a * link.T_a_b;
      else if (b && !a)
        a = *b * link.T_a_b.inverse();
      else
        continue;
      grown = true;
      break;
    }
  }
  return T_ref_sensor;
}

/// Does no LiDAR share as many views with a camera as planes take?
bool few_views(const std::vector<ViewSights>& views, std::size_t lidars) {
  std::size_t most = 0;
  for (std::size_t l = 0; l < lidars; ++l) most = std::max(most, candidate_views(views, l));
  return most == 1 || most == 2;
}

/// Somebody's guess of where a LiDAR is, from any camera that has a place.
std::optional<Pose> guess_of_lidar(const std::vector<PlaceGuess>& guesses,
                                   const std::vector<std::optional<Pose>>& T_ref_camera, std::size_t lidar) {
  for (std::size_t c = 0; c < T_ref_camera.size(); ++c) {
    const auto said = guess_of(guesses, static_cast<int>(c), static_cast<int>(T_ref_camera.size() + lidar));
    if (said && T_ref_camera[c]) return *T_ref_camera[c] * *said;
  }
  return std::nullopt;
}

}  // namespace

Result<RigSeed> seed_rig(const Board& board, const std::vector<ViewSights>& views,
                         const std::vector<std::string>& cameras, const std::vector<std::string>& lidars,
                         const SeedOptions& options) {
  const int camera_count = static_cast<int>(cameras.size());
  const std::size_t sensors = cameras.size() + lidars.size();
  RigSeed result;
  result.by_rims = options.rims && board.outline && few_views(views, lidars.size());
  std::vector<std::vector<std::vector<PatchPlane>>> patches(lidars.size());  // [lidar][view]
  for (std::size_t l = 0; l < lidars.size(); ++l) {
    for (const ViewSights& view : views) patches[l].push_back(patches_of(view.lidars[l]));
  }
  std::vector<Link> links;
  for (int c = 0; c < camera_count; ++c) {
    for (int other = c + 1; other < camera_count; ++other) {
      const auto guess = guess_of(options.guesses, c, other);
      if (const auto link = link_cameras(board, views, c, other, result.by_rims, guess))
        links.push_back(*link);
    }
    for (int l = 0; l < static_cast<int>(lidars.size()); ++l) {
      const auto& seen = patches[static_cast<std::size_t>(l)];
      if (const auto link = link_lidar(board, views, seen, c, l, camera_count, options.seed, options.stop))
        links.push_back(*link);
    }
  }
  std::vector<std::optional<Pose>> T_ref_sensor = grow(std::move(links), sensors);
  std::vector<std::optional<RimSeed>> by_rims(lidars.size());
  std::vector<Problem> problems;
  const std::vector<std::optional<Pose>> T_ref_camera(T_ref_sensor.begin(),
                                                      T_ref_sensor.begin() + camera_count);
  for (std::size_t l = 0; l < lidars.size() && result.by_rims; ++l) {
    if (candidate_views(views, l) == 0) continue;
    const auto seed = seed_by_rims({board, views, T_ref_camera, l, patches[l], lidars[l], cameras[0],
                                    guess_of_lidar(options.guesses, T_ref_camera, l)});
    if (seed) {
      by_rims[l] = *seed;
      T_ref_sensor[cameras.size() + l] = seed->T_ref_lidar;
    } else {
      problems.insert(problems.end(), seed.error().problems.begin(), seed.error().problems.end());
    }
  }
  for (std::size_t i = 0; i < sensors; ++i) {
    const bool camera = i < cameras.size();
    const std::string& name = camera ? cameras[i] : lidars[i - cameras.size()];
    if (T_ref_sensor[i]) {
      (camera ? result.T_ref_camera : result.T_ref_lidar).push_back(*T_ref_sensor[i]);
      continue;
    }
    const bool told = std::any_of(problems.begin(), problems.end(),
                                  [&](const Problem& problem) { return problem.where == name; });
    if (told) continue;
    const std::size_t shared = camera ? views.size() : candidate_views(views, i - cameras.size());
    problems.push_back(camera && result.by_rims ? two_ways(name, cameras[0])
                                                : no_place(board, name, cameras[0], shared, views));
  }
  if (!problems.empty()) return fail(ErrorCode::refused, std::move(problems));

  for (std::size_t v = 0; v < views.size(); ++v) {
    const ViewSights& view = views[v];
    auto& chosen = result.chosen.emplace_back(lidars.size(), -1);
    auto& turned = result.turned.emplace_back(cameras.size(), false);
    std::optional<Pose>
        T_ref_board;  // from the first camera that saw it: the others follow its choice of ids
    for (std::size_t c = 0; c < cameras.size(); ++c) {
      if (!view.cameras[c]) continue;
      const Pose pose = result.T_ref_camera[c] * view.cameras[c]->pose.T_camera_board;
      if (!T_ref_board) {
        T_ref_board = pose;
        for (std::size_t l = 0; l < lidars.size(); ++l) {
          if (view.lidars[l].empty()) continue;
          if (by_rims[l] && by_rims[l]->chosen[v] >= 0) {
            chosen[l] = by_rims[l]->chosen[v];
            continue;
          }
          const Consensus match = match_hypotheses({consensus_view(board, *view.cameras[c], patches[l][v])},
                                                   result.T_ref_camera[c].inverse() * result.T_ref_lidar[l],
                                                   consensus_options(board, options.seed));
          chosen[l] = match.patch[0];
        }
      } else if (board.type->half_turn_ambiguous(board)) {
        turned[c] = pose.R.col(0).dot(T_ref_board->R.col(0)) < 0;
      }
    }
  }
  return result;
}

std::vector<std::vector<std::vector<Corner>>> settled_corners(const std::vector<ViewSights>& views,
                                                              const RigSeed& seed, int count) {
  std::vector<std::vector<std::vector<Corner>>> corners;
  for (std::size_t v = 0; v < views.size(); ++v) {
    auto& here = corners.emplace_back(views[v].cameras.size());
    for (std::size_t c = 0; c < here.size(); ++c) {
      if (!views[v].cameras[c]) continue;
      here[c] = views[v].cameras[c]->corners;
      if (seed.turned[v][c]) turn_ids(here[c], count);
    }
  }
  return corners;
}

std::vector<Pose> seeded_boards(const std::vector<ViewSights>& views, const RigSeed& seed) {
  std::vector<Pose> T_ref_board(views.size());
  for (std::size_t v = 0; v < views.size(); ++v) {
    for (std::size_t c = views[v].cameras.size(); c-- > 0;) {
      if (!views[v].cameras[c]) continue;
      const Pose& pose = views[v].cameras[c]->pose.T_camera_board;
      T_ref_board[v] = seed.T_ref_camera[c] * (seed.turned[v][c] ? half_turned(pose) : pose);
    }
  }
  return T_ref_board;
}

}  // namespace ca2
