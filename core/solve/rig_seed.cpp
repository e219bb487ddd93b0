#include "core/solve/rig_seed.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/solve/consensus.h"
#include "core/solve/view_use.h"
#include "core/types/text.h"

namespace ca2 {
namespace {

/// So many returns of a patch tell its spread well enough.
constexpr std::size_t enough_returns = 200;

/// Why a sensor has no place: nothing is said of views agreeing where there are not three.
Problem no_place(const std::string& sensor, const std::string& reference, std::size_t shared,
                 const std::vector<ViewSights>& views) {
  if (shared >= 3)
    return {sensor, "no three views agree on where this sensor sits relative to " + reference,
            "show the board to both at once, at different tilts; check the board's size in the rig"};
  Problem problem{sensor,
                  formatted("this sensor and a camera see the board together in %zu of %zu views, and three "
                            "are the least that determine the answer",
                            shared, views.size()),
                  "show the board in more places, each at another tilt"};
  for (const ViewSights& view : views) {
    if (view.problem.empty()) continue;
    problem.what += formatted(" (view %d: %s)", view.id, view.problem.c_str());
    break;
  }
  return problem;
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

/// Relative pose of two cameras from the board poses of shared views; half-turn ambiguity settled by the
/// largest group of views that agree.
std::optional<Link> link_cameras(const Board& board, const std::vector<ViewSights>& views, int a, int b) {
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
    if (support > best.support) best = {a, b, proposals[i], support};
  }
  if (best.support == 0) return std::nullopt;
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

}  // namespace

Pose half_turned(const Pose& T_sensor_board) {
  Pose turned = T_sensor_board;
  turned.R.col(0) = -turned.R.col(0);
  turned.R.col(1) = -turned.R.col(1);
  return turned;
}

void turn_ids(std::vector<Corner>& corners, int count) {
  for (Corner& corner : corners) corner.id = count - 1 - corner.id;
}

Result<RigSeed> seed_rig(const Board& board, const std::vector<ViewSights>& views,
                         const std::vector<std::string>& cameras, const std::vector<std::string>& lidars,
                         std::uint64_t seed, std::stop_token stop) {
  const int camera_count = static_cast<int>(cameras.size());
  const int sensors = camera_count + static_cast<int>(lidars.size());
  std::vector<std::vector<std::vector<PatchPlane>>> patches(lidars.size());  // [lidar][view]
  for (std::size_t l = 0; l < lidars.size(); ++l) {
    for (const ViewSights& view : views) patches[l].push_back(patches_of(view.lidars[l]));
  }
  std::vector<Link> links;
  for (int c = 0; c < camera_count; ++c) {
    for (int other = c + 1; other < camera_count; ++other) {
      if (const auto link = link_cameras(board, views, c, other)) links.push_back(*link);
    }
    for (int l = 0; l < static_cast<int>(lidars.size()); ++l) {
      const auto& seen = patches[static_cast<std::size_t>(l)];
      if (const auto link = link_lidar(board, views, seen, c, l, camera_count, seed, stop))
        links.push_back(*link);
    }
  }
  std::stable_sort(links.begin(), links.end(),
                   [](const Link& x, const Link& y) { return x.support > y.support; });

  // Grow from the reference along the strongest link that reaches a new sensor.
  std::vector<std::optional<Pose>> T_ref_sensor(static_cast<std::size_t>(sensors));
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
  RigSeed result;
  std::vector<Problem> problems;
  for (int s = 0; s < sensors; ++s) {
    const auto i = static_cast<std::size_t>(s);
    const std::string& name = s < camera_count ? cameras[i] : lidars[i - cameras.size()];
    if (!T_ref_sensor[i]) {
      problems.push_back(
          no_place(name, cameras[0],
                   s < camera_count ? views.size() : candidate_views(views, i - cameras.size()), views));
    } else {
      (s < camera_count ? result.T_ref_camera : result.T_ref_lidar).push_back(*T_ref_sensor[i]);
    }
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
          const Consensus match = match_hypotheses({consensus_view(board, *view.cameras[c], patches[l][v])},
                                                   result.T_ref_camera[c].inverse() * result.T_ref_lidar[l],
                                                   consensus_options(board, seed));
          chosen[l] = match.patch[0];
        }
      } else if (board.type->half_turn_ambiguous(board)) {
        turned[c] = pose.R.col(0).dot(T_ref_board->R.col(0)) < 0;
      }
    }
  }
  return result;
}

}  // namespace ca2
