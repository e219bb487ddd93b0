#include "tools/sim/person_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tools/sim/furnishing.h"
#include "tools/sim/placement.h"

namespace ca2 {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double first_stay = 2.0;  // s out of view: the room is seen empty
constexpr double last_stay = 1.0;
// Holds differ by at least so much: a view must teach.
constexpr double least_turn = 0.25;   // rad
constexpr double least_shift = 0.15;  // of the distance

double uniform(std::mt19937_64& rng, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(rng);
}

/// Position of least jerk between 0 and 1 (Flash and Hogan, 1985).
double least_jerk(double s) {
  return s * s * s * (10 - 15 * s + 6 * s * s);
}

/// Between two places as somebody carries a plate round the rig.
Pose between(const Pose& a, const Pose& b, double s) {
  const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(a.t.normalized(), b.t.normalized());
  const Eigen::Vector3d direction = Eigen::Quaterniond::Identity().slerp(s, turn) * a.t.normalized();
  const double distance = (1 - s) * a.t.norm() + s * b.t.norm();
  return {Eigen::Quaterniond(a.R).slerp(s, Eigen::Quaterniond(b.R)).toRotationMatrix(), distance * direction};
}

bool alike(const Pose& a, const Pose& b) {
  const Vector6d d = a.difference(b);
  return d.head<3>().norm() < least_turn && d.tail<3>().norm() < least_shift * a.t.norm();
}

}  // namespace

PersonMotion::PersonMotion(const Scenario& scenario, std::mt19937_64& rng) : scenario_(&scenario) {
  const Outline extent = scenario.board.extent();
  const double rim = 0.5 * std::hypot(extent.width, extent.height);
  const auto draw = [&](std::array<Wave, 5>& waves, double unit) {
    // Two slow ones of the arms, three of the hands; a sine of amplitude a is a / sqrt(2) rms.
    for (std::size_t i = 0; i < waves.size(); ++i) {
      const bool slow = i < 2;
      const double rms = unit * (slow ? scenario.carrying.drift / std::sqrt(2.0)
                                      : scenario.carrying.tremor / std::sqrt(3.0));
      waves[i] = {std::sqrt(2.0) * rms, slow ? uniform(rng, 0.15, 0.8) : uniform(rng, 6, 11),
                  uniform(rng, 0, 2 * pi)};
    }
  };
  for (std::size_t axis = 0; axis < 3; ++axis) draw(tremor_[axis], 1 / rim);
  for (std::size_t axis = 3; axis < 6; ++axis) draw(tremor_[axis], 1);
  looks_.seed(rng());
}

/// Behind the rig as its first camera looks, the board hanging from a hand.
Pose PersonMotion::away() const {
  Eigen::Vector3d ahead = scenario_->cameras.empty()
                              ? Eigen::Vector3d::UnitX()
                              : Eigen::Vector3d(scenario_->cameras.begin()->second.T_rig_camera.R.col(2));
  ahead.z() = 0;
  if (ahead.norm() < 0.1) ahead = Eigen::Vector3d::UnitX();
  ahead.normalize();
  Pose pose;
  // Its edge towards the rig, aside of straight behind so that the way round is one way.
  const Eigen::Vector3d place = so3_exp({0, 0, 0.15}) * -ahead;
  pose.R.col(1) = -Eigen::Vector3d::UnitZ();
  pose.R.col(0) = place;
  pose.R.col(2) = pose.R.col(0).cross(pose.R.col(1));
  pose.t = 1.6 * place;
  pose.t.z() = scenario_->room ? 0.9 - scenario_->room->rig_height : 0;
  return pose;
}

void PersonMotion::stay(const Pose& T_rig_board, double duration, double move) {
  Stop stop;
  stop.T_rig_board = T_rig_board;
  stop.from = stops_.empty() ? 0 : stops_.back().to + move;
  stop.to = stop.from + duration;
  duration_ = stop.to;
  stops_.push_back(stop);
}

Result<PersonMotion> PersonMotion::plan(const Scenario& scenario) {
  std::mt19937_64 rng = view_generator(scenario, 0);
  PersonMotion motion(scenario, rng);
  const Carrying& carrying = scenario.carrying;
  const Pose outside = motion.away();
  motion.stay(outside, first_stay, 0);
  for (int id = 1; id <= scenario.views; ++id) {
    std::mt19937_64 own = view_generator(scenario, id);
    TrueHold hold;
    hold.id = id;
    hold.sensors = sensors_of_view(scenario, id);
    constexpr int tries = 50;
    for (int i = 0;; ++i) {
      const Result<Pose> place = place_board(scenario, hold.sensors, own);
      if (!place) return fail(place.error());
      hold.T_rig_board = *place;
      if (std::none_of(motion.holds_.begin(), motion.holds_.end(),
                       [&](const TrueHold& other) { return alike(other.T_rig_board, *place); })) {
        break;
      }
      if (i >= tries) {
        return fail(ErrorCode::config, scenario.name,
                    "there is no room for " + std::to_string(scenario.views) + " different holds",
                    "ask for fewer, or widen the distances and tilts");
      }
    }
    const auto moves = [&] { return uniform(own, carrying.min_move, carrying.max_move); };
    if (id > 1 && uniform(own, 0, 1) < carrying.away) motion.stay(outside, 0.5, 2 * moves());
    const bool from_outside = motion.stops_.back().T_rig_board.t == outside.t;
    motion.stay(hold.T_rig_board, uniform(own, carrying.min_hold, carrying.max_hold),
                from_outside ? 2 * moves() : moves());
    hold.from = motion.stops_.back().from;
    hold.to = motion.stops_.back().to;
    motion.holds_.push_back(std::move(hold));
  }
  motion.stay(outside, last_stay, 2 * carrying.max_move);
  return motion;
}

Pose PersonMotion::at(double time) const {
  Pose pose = stops_.back().T_rig_board;
  for (std::size_t i = 0; i < stops_.size(); ++i) {
    if (time <= stops_[i].to) {
      const bool moving = i > 0 && time < stops_[i].from;
      pose = moving ? between(stops_[i - 1].T_rig_board, stops_[i].T_rig_board,
                              least_jerk((time - stops_[i - 1].to) / (stops_[i].from - stops_[i - 1].to)))
                    : stops_[i].T_rig_board;
      break;
    }
  }
  Vector6d d = Vector6d::Zero();
  for (std::size_t axis = 0; axis < 6; ++axis) {
    for (const Wave& wave : tremor_[axis])
      d[static_cast<Eigen::Index>(axis)] +=
          wave.amplitude * std::sin(2 * pi * wave.frequency * time + wave.phase);
  }
  return pose.perturbed(d);
}

/// Along an arc behind all holds, or away from them where the room is too small for that.
Eigen::Vector2d PersonMotion::walker(double time) const {
  const Room& room = *scenario_->room;
  const double reach = std::min(room.length, room.width) / 2 - 0.6;
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  double farthest = 0;
  for (const TrueHold& hold : holds_) {
    middle += hold.T_rig_board.t.head<2>().normalized();
    farthest = std::max(farthest, hold.T_rig_board.t.head<2>().norm());
  }
  double spread = 0;
  for (const TrueHold& hold : holds_) {
    const double cosine = hold.T_rig_board.t.head<2>().normalized().dot(middle.normalized());
    spread = std::max(spread, std::acos(std::clamp(cosine, -1.0, 1.0)));
  }
  const double behind = std::atan2(-middle.y(), -middle.x());
  // Clear of the board and of who holds it: 1.2 m behind them, or 0.6 rad beside.
  const double swing = reach > farthest + 1.2 ? pi : std::max(0.0, pi - spread - 0.6);
  const double angle = behind + swing * std::sin(2 * pi * time / 17);
  return reach * Eigen::Vector2d(std::cos(angle), std::sin(angle));
}

void PersonMotion::add_to(Scene& scene, double time) const {
  const Pose T_rig_board = at(time);
  const int board = add_board(scene, scenario_->board, scenario_->bend, T_rig_board);
  const Plate plate = scene.solids[static_cast<std::size_t>(board)].plate;
  std::mt19937_64 looks = looks_;
  if (scenario_->room->person) add_holder(scene, *scenario_->room, plate, T_rig_board, looks);
  if (scenario_->room->second_person) add_walker(scene, *scenario_->room, walker(time), looks);
}

}  // namespace ca2
