#include "core/solve/calibrate.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "ca2_version.h"
#include "core/geometry/adjoint.h"
#include "core/solve/beam_lenses.h"
#include "core/solve/correction_notes.h"
#include "core/solve/observability.h"
#include "core/solve/plane_pairs.h"
#include "core/solve/rig_seed.h"
#include "core/solve/rim_conflict.h"
#include "core/solve/view_use.h"
#include "core/types/text.h"

namespace ca2 {
namespace {

struct Names {
  std::vector<std::string> cameras, lidars;

  /// Of a sensor, cameras first.
  int index(const std::string& name) const {
    const auto camera = std::find(cameras.begin(), cameras.end(), name);
    if (camera != cameras.end()) return static_cast<int>(camera - cameras.begin());
    return static_cast<int>(cameras.size()) +
           static_cast<int>(std::find(lidars.begin(), lidars.end(), name) - lidars.begin());
  }
};

Names names_of(const Rig& rig) {
  Names names;
  for (const auto& [name, camera] : rig.cameras) names.cameras.push_back(name);
  for (const auto& [name, lidar] : rig.lidars) names.lidars.push_back(name);
  return names;
}

/// What the rig says of where its sensors are.
std::vector<PlaceGuess> guesses_of(const Rig& rig, const Names& names) {
  std::vector<PlaceGuess> guesses;
  for (const RigExtrinsic& said : rig.extrinsics)
    guesses.push_back({names.index(said.parent), names.index(said.child), said.T_parent_child});
  return guesses;
}

CalibratedTransform named_transform(const Rig& rig, const std::string& parent, const std::string& child) {
  const auto frame = [&](const std::string& name) {
    const auto camera = rig.cameras.find(name);
    return camera != rig.cameras.end() ? camera->second.frame : rig.lidars.at(name).frame;
  };
  CalibratedTransform transform;
  transform.parent = parent;
  transform.child = child;
  transform.parent_frame = frame(parent);
  transform.child_frame = frame(child);
  return transform;
}

double rms(const std::vector<double>& values) {
  double squares = 0;
  for (const double value : values) squares += value * value;
  return values.empty() ? 0 : std::sqrt(squares / static_cast<double>(values.size()));
}

void worsen(Observability& all, const Observability& one) {
  if (all.verdict.empty() || (all.verdict == "good" && one.verdict == "weak") ||
      (all.verdict == one.verdict && one.condition > all.condition)) {
    all = one;
  }
}

// --- The joint method
// -------------------------------------------------------------------------------------------

/// Names, poses and covariances out of the joint solver's numbered unknowns.
class JointReport {
 public:
  JointReport(const Rig& rig, const Names& names, const std::vector<ViewSights>& views,
              const JointAnswer& answer, const CalibrateOptions& options)
      : rig_(rig), names_(names), views_(views), answer_(answer), options_(options) {}

  Result<Calibration> make() const {
    Calibration calibration;
    calibration.software = "ca2 " CA2_VERSION;
    calibration.method = "joint";
    std::vector<Problem> refusals;
    for (std::size_t c = 0; c < names_.cameras.size(); ++c) {
      for (std::size_t l = 0; l < names_.lidars.size(); ++l) add_pair(c, l, calibration, refusals);
    }
    for (std::size_t c = 1; c < names_.cameras.size(); ++c) {
      CalibratedTransform transform = named_transform(rig_, names_.cameras[0], names_.cameras[c]);
      transform.T_parent_child = answer_.state.T_ref_camera[c];
      transform.covariance = answer_.covariance.block<6, 6>(camera_index(c), camera_index(c));
      calibration.transforms.push_back(transform);
    }
    if (!refusals.empty()) return fail(ErrorCode::refused, std::move(refusals));
    add_sensors(calibration);
    add_views(calibration);
    add_notes(calibration);
    return calibration;
  }

 private:
  Eigen::Index camera_index(std::size_t c) const { return 6 * (static_cast<Eigen::Index>(c) - 1); }
  Eigen::Index lidar_index(std::size_t l) const {
    return 6 * static_cast<Eigen::Index>(names_.cameras.size() - 1 + l);
  }
  Eigen::Index intrinsics_index(std::size_t c) const {
    return std::accumulate(answer_.free_intrinsics.begin(),
                           answer_.free_intrinsics.begin() + static_cast<std::ptrdiff_t>(c),
                           lidar_index(names_.lidars.size()));
  }
  Eigen::Index stretch_index() const { return intrinsics_index(names_.cameras.size()); }
  Eigen::Index bias_index(std::size_t l) const {
    return stretch_index() + (answer_.stretch_free ? 2 : 0) + static_cast<Eigen::Index>(l);
  }

  /// Derivative of T_camera_lidar (right perturbation) by the globals.
  Eigen::Matrix<double, 6, Eigen::Dynamic> pair_jacobian(std::size_t c, std::size_t l,
                                                         const Pose& T_camera_lidar) const {
    Eigen::Matrix<double, 6, Eigen::Dynamic> J =
        Eigen::Matrix<double, 6, Eigen::Dynamic>::Zero(6, answer_.covariance.rows());
    J.middleCols<6>(lidar_index(l)).setIdentity();
    if (c > 0) {
      J.middleCols<6>(camera_index(c)) = -adjoint(T_camera_lidar.inverse());
    }
    return J;
  }

  void add_pair(std::size_t c, std::size_t l, Calibration& calibration,
                std::vector<Problem>& refusals) const {
    CalibratedTransform transform = named_transform(rig_, names_.cameras[c], names_.lidars[l]);
    transform.T_parent_child = answer_.state.T_ref_camera[c].inverse() * answer_.state.T_ref_lidar[l];
    const auto J = pair_jacobian(c, l, transform.T_parent_child);
    PairEvidence evidence;
    evidence.camera = names_.cameras[c];
    evidence.lidar = names_.lidars[l];
    evidence.T_camera_lidar = transform.T_parent_child;
    if (answer_.covariance.allFinite()) {
      transform.covariance = J * answer_.covariance * J.transpose();
    } else {
      transform.covariance = Matrix6d::Identity() * std::numeric_limits<double>::infinity();
    }
    evidence.covariance = transform.covariance;
    evidence.candidates = static_cast<int>(candidate_views(views_, l));
    evidence.rims = answer_.edges > 0 && !answer_.edges_dropped;
    double variance = 0;
    for (std::size_t v = 0; v < views_.size(); ++v) {
      if (!answer_.views[v].used || answer_.chosen[v][l] < 0) continue;
      evidence.normals.push_back(
          board_plane(answer_.state.T_ref_camera[c].inverse() * answer_.state.T_ref_board[v]).normal);
      for (const auto& sight : views_[v].cameras) {
        if (!sight) continue;
        variance += sight->pose.covariance.topLeftCorner<2, 2>().trace() / 2;
        break;
      }
    }
    evidence.normal_sigma =
        std::sqrt(variance / std::max<double>(1, static_cast<double>(evidence.normals.size())));
    const Result<Observability> verdict = judge(evidence);
    if (!verdict) {
      refusals.insert(refusals.end(), verdict.error().problems.begin(), verdict.error().problems.end());
      return;
    }
    worsen(calibration.observability, *verdict);
    calibration.transforms.push_back(transform);
    add_leave_one_out(J, calibration.validation);
  }

  void add_leave_one_out(const Eigen::Matrix<double, 6, Eigen::Dynamic>& J, Validation& validation) const {
    if (answer_.leave_one_out.rows() == 0) {
      validation.leave_one_out_translation = validation.leave_one_out_rotation =
          std::numeric_limits<double>::quiet_NaN();
      return;
    }
    const Eigen::MatrixXd changes = answer_.leave_one_out * J.transpose();
    const double count = static_cast<double>(changes.rows());
    validation.leave_one_out_rotation =
        std::max(validation.leave_one_out_rotation, std::sqrt(changes.leftCols<3>().squaredNorm() / count));
    validation.leave_one_out_translation = std::max(validation.leave_one_out_translation,
                                                    std::sqrt(changes.rightCols<3>().squaredNorm() / count));
  }

  void add_sensors(Calibration& calibration) const {
    for (std::size_t c = 0; c < names_.cameras.size(); ++c) {
      CalibratedCamera& camera = calibration.cameras[names_.cameras[c]];
      camera.camera = answer_.state.cameras[c];
      camera.sigma.assign(static_cast<std::size_t>(camera.camera.parameters.size()), 0);
      const auto own = options_.estimated.find(names_.cameras[c]);
      if (own != options_.estimated.end()) {
        camera.sigma.assign(own->second.data(), own->second.data() + own->second.size());
        camera.sigma.resize(static_cast<std::size_t>(camera.camera.parameters.size()), 0);
      }
      camera.estimated = options_.prior_focal > 0 || own != options_.estimated.end();
      for (Eigen::Index k = 0; k < answer_.free_intrinsics[c] && camera.estimated; ++k) {
        const Eigen::Index i = intrinsics_index(c) + k;
        camera.sigma[static_cast<std::size_t>(k)] = std::sqrt(answer_.covariance(i, i));
      }
    }
    if (answer_.stretch_free) {
      const Eigen::Vector2d variance = answer_.covariance.diagonal().segment<2>(stretch_index());
      calibration.print = {answer_.state.stretch, variance.cwiseSqrt(), true};
    }
    for (std::size_t l = 0; l < names_.lidars.size(); ++l) {
      const Eigen::Index i = bias_index(l);
      calibration.lidars[names_.lidars[l]] = {
          answer_.state.range_bias[l], options_.prior_bias > 0 ? std::sqrt(answer_.covariance(i, i)) : 0,
          answer_.range_sigma[l], options_.prior_bias > 0};
    }
  }

  std::size_t lidar_views() const {
    std::size_t count = 0;
    for (std::size_t v = 0; v < views_.size(); ++v) {
      const std::vector<int>& chosen = answer_.chosen[v];
      count += answer_.views[v].used && *std::max_element(chosen.begin(), chosen.end()) >= 0 ? 1 : 0;
    }
    return count;
  }

  void add_notes(Calibration& calibration) const {
    if (answer_.by_rims) calibration.notes.push_back(few_views_note(lidar_views()));
    for (std::string& note : correction_notes(rig_, views_, answer_, calibration.print))
      calibration.notes.push_back(std::move(note));
    if (answer_.edges_dropped) {
      calibration.notes.push_back(
          "the plates' edges contradict the planes and were left out: is the outline in the rig right?");
    }
    for (std::size_t l = 0; l < names_.lidars.size(); ++l) {
      if (answer_.view_sigma[l] > 0) {
        calibration.notes.push_back(
            formatted("the returns of %s err together, view by view, by %.1f mm: the sigmas include it",
                      names_.lidars[l].c_str(), 1e3 * answer_.view_sigma[l]));
      }
    }
    if (answer_.camera_factor > 1) {
      calibration.notes.push_back(formatted(
          "the cameras disagree %.1f times more than their corners' noise explains: the sigmas include it",
          std::sqrt(answer_.camera_factor)));
    }
    if (answer_.variance_factor > 1) {
      calibration.notes.push_back(
          formatted("the views disagree %.1f times more than their noise explains: the sigmas include it",
                    std::sqrt(answer_.variance_factor)));
    }
  }

  void add_views(Calibration& calibration) const {
    std::vector<double> reprojection;
    std::vector<double> range;
    for (std::size_t v = 0; v < views_.size(); ++v) {
      const JointViewOutcome& outcome = answer_.views[v];
      calibration.views.push_back(
          {views_[v].id, outcome.used, outcome.reason, outcome.reprojection_rms, outcome.plane_rms});
      if (!outcome.used) continue;
      reprojection.push_back(outcome.reprojection_rms);
      range.push_back(outcome.plane_rms);
    }
    calibration.validation.reprojection_rms = rms(reprojection);
    calibration.validation.range_rms = rms(range);
    for (const double offset : answer_.outline_offset) {
      if (!std::isfinite(offset)) continue;
      calibration.validation.outline_offset =
          std::max(offset, calibration.validation.outline_offset.value_or(0));
    }
  }

  const Rig& rig_;
  const Names& names_;
  const std::vector<ViewSights>& views_;
  const JointAnswer& answer_;
  const CalibrateOptions& options_;
};

// --- The published methods
// --------------------------------------------------------------------------------------

std::optional<PlaneToPlaneResult> solve_planes(std::span<const PlanePair> pairs, Method method) {
  if (method == Method::plane_to_plane) return solve_plane_to_plane(pairs);
  const std::optional<Pose> pose = solve_closed_form(pairs);
  if (!pose) return std::nullopt;
  return plane_to_plane_at(pairs, *pose);
}

/// How far the answer moves when one pair is left out: rms over the pairs, (translation m, rotation rad).
std::pair<double, double> leave_one_out(const std::vector<PlanePair>& pairs, const Pose& all, Method method,
                                        const std::stop_token& stop) {
  std::vector<double> translation;
  std::vector<double> rotation;
  for (std::size_t i = 0; i < pairs.size() && pairs.size() > 3 && !stop.stop_requested(); ++i) {
    std::vector<PlanePair> others = pairs;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    const auto result = solve_planes(others, method);
    if (!result) continue;
    const Vector6d d = all.difference(result->T_camera_lidar);
    rotation.push_back(d.head<3>().norm());
    translation.push_back(d.tail<3>().norm());
  }
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  return {translation.empty() ? unknown : rms(translation), rotation.empty() ? unknown : rms(rotation)};
}

Result<Calibration> calibrate_planes(const Rig& rig, const Names& names, const std::vector<ViewSights>& views,
                                     const RigSeed& seed, Method method, const std::stop_token& stop) {
  Calibration calibration;
  calibration.software = "ca2 " CA2_VERSION;
  calibration.method = method == Method::kim ? "kim" : "plane_to_plane";
  std::vector<Problem> refusals;
  std::vector<bool> used(views.size(), false);
  for (std::size_t c = 0; c < names.cameras.size(); ++c) {
    for (std::size_t l = 0; l < names.lidars.size(); ++l) {
      std::vector<PlanePair> pairs;
      PairEvidence evidence{names.cameras[c],
                            names.lidars[l],
                            {},
                            Matrix6d::Zero(),
                            {},
                            0,
                            static_cast<int>(candidate_views(views, l)),
                            false};
      for (std::size_t v = 0; v < views.size(); ++v) {
        if (!views[v].cameras[c] || seed.chosen[v][l] < 0) continue;
        pairs.push_back({board_plane(views[v].cameras[c]->pose.T_camera_board),
                         views[v].lidars[l][static_cast<std::size_t>(seed.chosen[v][l])].plane});
        evidence.normals.push_back(pairs.back().camera.normal);
        used[v] = true;
      }
      const auto result = solve_planes(pairs, method);
      CalibratedTransform transform = named_transform(rig, names.cameras[c], names.lidars[l]);
      if (result) {
        transform.T_parent_child = result->T_camera_lidar;
        transform.covariance =
            result->residual_variance * result->information.ldlt().solve(Matrix6d::Identity());
      } else {
        transform.covariance.diagonal().setConstant(std::numeric_limits<double>::infinity());
      }
      evidence.T_camera_lidar = transform.T_parent_child;
      evidence.covariance = transform.covariance;
      const Result<Observability> verdict = judge(evidence);
      if (!verdict) {
        refusals.insert(refusals.end(), verdict.error().problems.begin(), verdict.error().problems.end());
        continue;
      }
      worsen(calibration.observability, *verdict);
      calibration.transforms.push_back(transform);
      const auto [translation, rotation] = leave_one_out(pairs, transform.T_parent_child, method, stop);
      calibration.validation.leave_one_out_translation = translation;
      calibration.validation.leave_one_out_rotation = rotation;
    }
  }
  if (!refusals.empty()) return fail(ErrorCode::refused, std::move(refusals));
  for (const std::string& name : names.cameras) {
    const Camera& camera = *rig.cameras.at(name).intrinsics;
    calibration.cameras[name] = {camera, false,
                                 std::vector<double>(static_cast<std::size_t>(camera.parameters.size()), 0)};
  }
  std::vector<double> reprojection;
  std::vector<double> plane;
  for (const std::string& name : names.lidars) calibration.lidars[name] = {};
  for (std::size_t v = 0; v < views.size(); ++v) {
    CalibratedView view{views[v].id, used[v],
                        used[v] ? "" : "no pair of planes that agrees with the other views", 0, 0};
    for (const auto& sight : views[v].cameras) {
      if (sight) view.reprojection_rms = sight->pose.reprojection_rms;
    }
    for (std::size_t l = 0; l < names.lidars.size(); ++l) {
      if (seed.chosen[v][l] >= 0)
        view.plane_rms = views[v].lidars[l][static_cast<std::size_t>(seed.chosen[v][l])].rms;
    }
    if (view.used) {
      reprojection.push_back(view.reprojection_rms);
      plane.push_back(view.plane_rms);
    }
    calibration.views.push_back(view);
  }
  calibration.validation.reprojection_rms = rms(reprojection);
  calibration.validation.range_rms = rms(plane);
  for (auto& [name, lidar] : calibration.lidars) lidar.range_sigma = calibration.validation.range_rms;
  return calibration;
}

/// Whoever asked to stop knows why; what there is by then is no answer.
Result<Calibration> stopped() {
  return fail(ErrorCode::unavailable, "", "the calibration was stopped before it had an answer");
}

}  // namespace

Result<Calibration> calibrate(const Rig& rig, const std::vector<ViewSights>& views,
                              const CalibrateOptions& options) {
  const Names names = names_of(rig);
  std::vector<Camera> cameras;
  for (const auto& [name, camera] : rig.cameras) cameras.push_back(*camera.intrinsics);
  const Result<RigSeed> seed = seed_rig(rig.board, views, names.cameras, names.lidars,
                                        {.seed = options.seed,
                                         .rims = options.method == Method::joint,
                                         .guesses = guesses_of(rig, names),
                                         .stop = options.stop});
  if (options.stop.stop_requested()) return stopped();
  if (!seed) return fail(seed.error());
  if (options.method != Method::joint) {
    Result<Calibration> planes = calibrate_planes(rig, names, views, *seed, options.method, options.stop);
    return options.stop.stop_requested() ? stopped() : planes;
  }
  JointOptions joint;
  joint.prior_bias = options.prior_bias;
  joint.doubt_priors = {options.prior_distortion, options.prior_stretch, options.prior_size};
  joint.stop = options.stop;
  for (const RigExtrinsic& known : rig.extrinsics) {
    if (!known.fixed) continue;
    // A micrometre and a microradian: fixed to all purposes, and the equations stay well scaled.
    joint.relative.push_back({names.index(known.parent), names.index(known.child), known.T_parent_child,
                              1e12 * Matrix6d::Identity()});
  }
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    const CameraParameters& k = cameras[c].parameters;
    const double center = options.prior_focal > 0 ? options.prior_center : 0;
    Eigen::Vector4d sigma(options.prior_focal * k(0), options.prior_focal * k(1), center, center);
    // Estimated from these very views: held loosely, so that the corners are not counted twice.
    const auto own = options.estimated.find(names.cameras[c]);
    if (own != options.estimated.end()) sigma = sigma.cwiseMax(5 * own->second.head<4>());
    joint.prior_intrinsics.push_back(sigma);
    joint.stated.push_back(own == options.estimated.end());
  }
  const auto [answer, lenses] = solve_with_lenses(rig, cameras, views, *seed, std::move(joint));
  if (options.stop.stop_requested()) return stopped();
  if (std::vector<Problem> problems = unlikely_ranges(names.lidars, answer, options.prior_bias);
      !problems.empty())
    return fail(ErrorCode::refused, std::move(problems));
  Result<Calibration> calibration = JointReport(rig, names, views, answer, options).make();
  if (!calibration) return calibration;
  for (std::size_t l = 0; l < lenses.size(); ++l) {
    if (std::string note = lens_note(names.lidars[l], lenses[l]); !note.empty())
      calibration->notes.push_back(std::move(note));
  }
  return calibration;
}

}  // namespace ca2
