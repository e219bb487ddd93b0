#include "core/solve/rim_seed.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/board/ink_map.h"
#include "core/geometry/adjoint.h"
#include "core/solve/half_turn.h"
#include "core/solve/ink_evidence.h"
#include "core/solve/plate_fit.h"
#include "core/types/text.h"

namespace ca2 {
namespace {

/// What given intrinsics, ranges and rims may be off by beyond what the covariances know: rad, and m beside a
/// share of the distance.
constexpr double doubt_angle = 0.008, doubt_place = 0.008, doubt_share = 0.003;
/// chi-squared with 6 degrees of freedom: a bound two in a hundred thousand exceed by chance.
constexpr double agreed = 32;
/// Logarithm of the odds at which an answer is believed.
const double convincing = std::log(1000.0);
/// What a person's guess is worth where one answer is near it: more than doubt, less than what is seen.
constexpr double guess_worth = 10;
constexpr double guess_angle = M_PI / 6, guess_distance = 0.5;  // rad, m

/// Where the LiDAR sits if a patch is the board, and lies so.
struct Answer {
  Pose T_ref_lidar;
  Matrix6d covariance;     ///< right perturbation
  double log_odds = 0;     ///< of what was seen
  std::vector<int> patch;  ///< by view, -1: none
};

/// Of a pose whose frame is turned by half a turn about its z axis.
Matrix6d turned_covariance(const Matrix6d& covariance) {
  const Vector6d signs = (Vector6d() << -1, -1, 1, -1, -1, 1).finished();
  return signs.asDiagonal() * covariance * signs.asDiagonal();
}

Pose plate_on_board(const Board& board) {
  const Eigen::Vector2d center = board.extent().center;
  return {Eigen::Matrix3d::Identity(), {center.x(), center.y(), 0}};
}

/// A board by the first camera that saw it and has a place.
struct SeenBoard {
  Pose T_ref_board;
  Matrix6d covariance;  ///< right perturbation
};
std::optional<SeenBoard> board_in(const RimSeedRequest& ask, const ViewSights& view) {
  for (std::size_t c = 0; c < view.cameras.size(); ++c) {
    if (!view.cameras[c] || !ask.T_ref_camera[c]) continue;
    const BoardPose& pose = view.cameras[c]->pose;
    return SeenBoard{*ask.T_ref_camera[c] * pose.T_camera_board, pose.covariance};
  }
  return std::nullopt;
}

/// The answers of one view.
std::vector<Answer> answers_of(const RimSeedRequest& ask, std::size_t v, const InkMap& ink) {
  std::vector<Answer> answers;
  const ViewSights& view = ask.views[v];
  const std::optional<SeenBoard> board = board_in(ask, view);
  if (!board) return answers;
  const Outline outline = ask.board.extent();
  const Pose T_board_plate = plate_on_board(ask.board);
  const Matrix6d to_plate = adjoint(T_board_plate.inverse());
  // Where the plate lies evenly about the pattern, ids that begin at the other end are the plate turned.
  const bool either_end = ask.board.type->half_turn_ambiguous(ask.board) && !outline.center.isZero();
  for (std::size_t k = 0; k < view.lidars[ask.lidar].size(); ++k) {
    const LidarSight& sight = view.lidars[ask.lidar][k];
    for (const PlateFit& fit : fit_plate(sight, outline, ask.patches[v][k].normal_sigma)) {
      for (const bool turned : {false, true}) {
        const Pose T_lidar_plate = turned ? half_turned(fit.T_lidar_plate) : fit.T_lidar_plate;
        const double log_odds = ink_log_odds(sight, ink, outline, T_lidar_plate * T_board_plate.inverse());
        Vector6d doubt;
        const double place = std::hypot(doubt_place, doubt_share * T_lidar_plate.t.norm());
        doubt << Eigen::Vector3d::Constant(doubt_angle * doubt_angle),
            Eigen::Vector3d::Constant(place * place);
        Matrix6d by_lidar = turned ? turned_covariance(fit.covariance) : fit.covariance;
        by_lidar.diagonal() += doubt;
        const Matrix6d to_lidar = adjoint(T_lidar_plate);
        for (const bool other_end : {false, true}) {
          if (other_end && !either_end) continue;
          const Pose T_ref_pattern = other_end ? half_turned(board->T_ref_board) : board->T_ref_board;
          const Matrix6d by_camera = to_plate *
                                     (other_end ? turned_covariance(board->covariance) : board->covariance) *
                                     to_plate.transpose();
          Answer& answer = answers.emplace_back();
          answer.T_ref_lidar = T_ref_pattern * T_board_plate * T_lidar_plate.inverse();
          answer.covariance = to_lidar * (by_camera + by_lidar) * to_lidar.transpose();
          answer.log_odds = log_odds;
          answer.patch.assign(ask.views.size(), -1);
          answer.patch[v] = static_cast<int>(k);
        }
      }
    }
  }
  return answers;
}

/// chi-squared of two answers being one.
double disagreement(const Answer& a, const Answer& b) {
  const Vector6d d = a.T_ref_lidar.difference(b.T_ref_lidar);
  return d.dot((a.covariance + b.covariance).ldlt().solve(d));
}

/// The answers on which two views agree.
std::vector<Answer> agreeing(const std::vector<Answer>& first, const std::vector<Answer>& second) {
  std::vector<Answer> both;
  for (const Answer& a : first) {
    for (const Answer& b : second) {
      const double misfit = disagreement(a, b);
      if (!(misfit < agreed)) continue;
      Answer& answer = both.emplace_back(a);
      const Eigen::LDLT<Matrix6d> sum(a.covariance + b.covariance);
      const Vector6d d = a.T_ref_lidar.difference(b.T_ref_lidar);
      answer.T_ref_lidar = a.T_ref_lidar.perturbed(a.covariance * sum.solve(d));
      answer.covariance = a.covariance - a.covariance * sum.solve(a.covariance);
      answer.log_odds += b.log_odds - 0.5 * misfit;
      for (std::size_t v = 0; v < answer.patch.size(); ++v)
        answer.patch[v] = std::max(answer.patch[v], b.patch[v]);
    }
  }
  return both;
}

/// chi-squared of a patch of view `v` being the board as an answer has it: by the plane, and roughly the
/// place.
double patch_misfit(const RimSeedRequest& ask, const SeenBoard& board, const PatchPlane& patch,
                    const Answer& answer) {
  using Vector5d = Eigen::Matrix<double, 5, 1>;
  const Plane plane = facing_origin(patch.plane);
  // Perpendicular to where it should be, or seen from behind.
  const Pose T = answer.T_ref_lidar.inverse() * board.T_ref_board;
  if (plane.normal.dot(T.R.col(2)) > -0.5) return std::numeric_limits<double>::infinity();
  const Eigen::Vector2d middle = ask.board.extent().center;
  const auto error = [&](const Pose& T_ref_lidar) {
    const Pose there = T_ref_lidar.inverse() * board.T_ref_board;
    const Eigen::Vector3d centre = there * Eigen::Vector3d(middle.x(), middle.y(), 0);
    Vector5d e;
    e << plane.normal.dot(there.R.col(0)), plane.normal.dot(there.R.col(1)), plane.distance(centre),
        there.R.leftCols<2>().transpose() * (patch.center - centre);
    return e;
  };
  const Vector5d e = error(answer.T_ref_lidar);
  Eigen::Matrix<double, 5, 6> J;
  constexpr double step = 1e-6;
  for (int k = 0; k < 6; ++k)
    J.col(k) = (error(answer.T_ref_lidar.perturbed(step * Vector6d::Unit(k))) - e) / step;
  const double angle2 = std::pow(patch.normal_sigma, 2) + doubt_angle * doubt_angle;
  const double place2 = std::pow(doubt_place, 2) + std::pow(doubt_share * patch.center.norm(), 2);
  const double centre2 = std::pow(0.25 * std::max(ask.board.extent().width, ask.board.extent().height), 2);
  Eigen::Matrix<double, 5, 5> covariance = J * answer.covariance * J.transpose();
  covariance.diagonal() += (Vector5d() << angle2, angle2, place2, centre2, centre2).finished();
  return e.dot(covariance.ldlt().solve(e));
}

/// The answers that agree with one of the planes in view `v`, which shows no plate's rim.
std::vector<Answer> agreeing_with_planes(const RimSeedRequest& ask, std::size_t v,
                                         const std::vector<Answer>& answers) {
  const std::optional<SeenBoard> board = board_in(ask, ask.views[v]);
  std::vector<Answer> kept;
  for (const Answer& answer : answers) {
    double least = agreed;
    int patch = -1;
    for (std::size_t k = 0; k < ask.patches[v].size() && board; ++k) {
      const double misfit = patch_misfit(ask, *board, ask.patches[v][k], answer);
      if (misfit < least) least = misfit, patch = static_cast<int>(k);
    }
    if (patch < 0) continue;
    Answer& here = kept.emplace_back(answer);
    here.log_odds -= 0.5 * least;
    here.patch[v] = patch;
  }
  return kept;
}

bool near(const Pose& guess, const Answer& answer) {
  const Vector6d d = guess.difference(answer.T_ref_lidar);
  return d.head<3>().norm() <= guess_angle && d.tail<3>().norm() <= guess_distance;
}

/// The likeliest first, and of those that are one answer only that.
void rank(std::vector<Answer>& answers) {
  std::stable_sort(answers.begin(), answers.end(),
                   [](const Answer& a, const Answer& b) { return a.log_odds > b.log_odds; });
  std::vector<Answer> distinct;
  for (Answer& answer : answers) {
    const bool known = std::any_of(distinct.begin(), distinct.end(),
                                   [&](const Answer& other) { return disagreement(other, answer) < agreed; });
    if (!known) distinct.push_back(std::move(answer));
  }
  answers = std::move(distinct);
}

std::string names_of(const std::vector<int>& ids) {
  return ids.size() == 1 ? formatted("view %d", ids[0]) : formatted("views %d and %d", ids[0], ids[1]);
}

Problem disagreeing(const RimSeedRequest& ask, const std::vector<int>& ids) {
  return {ask.name,
          names_of(ids) + " do not agree on where this sensor sits relative to " + ask.reference +
              ": in one of them the board moved, or another object was taken for it",
          "show the board once more, still, in another place and at another tilt"};
}

Problem no_rim(const RimSeedRequest& ask, const std::vector<int>& ids) {
  return {
      ask.name,
      names_of(ids) +
          ": too little of the rim of a plate of the rig's outline was seen by this sensor, and "
          "planes alone take three views",
      "hold the board nearer, free of what is behind it, all of it in the sensor's sight; check the outline "
      "in the rig; or show it in more places, each at another tilt"};
}

Problem two_left(const RimSeedRequest& ask, const std::vector<int>& ids, const std::vector<Answer>& answers) {
  const double turn = answers[0].T_ref_lidar.difference(answers[1].T_ref_lidar).head<3>().norm();
  const bool same = answers[0].patch == answers[1].patch;
  const bool alike = ask.board.type->half_turn_ambiguous(ask.board);
  Problem problem{ask.name, names_of(ids) + (ids.size() == 1 ? " leaves" : " leave") + " two answers", ""};
  if (!same) {
    problem.what += ": more than one thing that this sensor saw may be the board";
  } else if (turn > 0.9 * M_PI) {
    problem.what += ", half a turn apart: the plate looks alike both ways round, ";
    problem.what +=
        alike ? "and so does its pattern" : "and the intensities of its squares do not tell which is right";
  } else {
    problem.what += formatted(", %.0f deg apart", turn * 180 / M_PI);
  }
  problem.hint = "show another view, at another tilt; or give a first guess in `extrinsics`";
  if (same && alike)
    problem.hint +=
        "; or use a board that half a turn changes (checkerboard: an odd and an even number of "
        "inner corners; ChArUco)";
  return problem;
}

}  // namespace

Result<RimSeed> seed_by_rims(const RimSeedRequest& ask) {
  const InkMap ink(ask.board);
  std::vector<Answer> answers;
  std::vector<int> ids;
  std::vector<std::size_t> rimless;
  bool any = false;
  for (std::size_t v = 0; v < ask.views.size(); ++v) {
    if (ask.patches[v].empty() || !board_in(ask, ask.views[v])) continue;
    ids.push_back(ask.views[v].id);
    std::vector<Answer> here = answers_of(ask, v, ink);
    if (here.empty()) {
      rimless.push_back(v);
    } else {
      answers = any ? agreeing(answers, here) : std::move(here);
      any = true;
    }
  }
  if (!any) return fail(ErrorCode::refused, std::vector{no_rim(ask, ids)});
  for (const std::size_t v : rimless) answers = agreeing_with_planes(ask, v, answers);
  if (answers.empty()) return fail(ErrorCode::refused, std::vector{disagreeing(ask, ids)});
  rank(answers);
  if (ask.guess) {
    const auto is_near = [&](const Answer& answer) { return near(*ask.guess, answer); };
    if (std::count_if(answers.begin(), answers.end(), is_near) == 1) {
      std::find_if(answers.begin(), answers.end(), is_near)->log_odds += guess_worth;
      rank(answers);
    }
  }
  if (answers.size() > 1 && answers[0].log_odds - answers[1].log_odds < convincing)
    return fail(ErrorCode::refused, std::vector{two_left(ask, ids, answers)});
  return RimSeed{answers[0].T_ref_lidar, answers[0].patch};
}

}  // namespace ca2
