/// @file A person who carries the board from place to place and holds it still there.
#pragma once

#include <array>
#include <random>
#include <vector>

#include "tools/sim/scenario.h"
#include "tools/sim/scene.h"

namespace ca2 {

/// The board stands still (but for the hands' tremor) from `from` to `to`, s from the recording's start.
struct TrueHold {
  int id = 0;
  double from = 0, to = 0;
  Pose T_rig_board;                  ///< mean
  std::vector<std::string> sensors;  ///< that see the board there
};

/// Where the board and the people are at any time. Moves have the least jerk, as those of hands have; they
/// lead round the rig, not through it.
class PersonMotion {
 public:
  /// The scenario's views become holds, no two alike; ErrorCode::config when there is no place for them.
  static Result<PersonMotion> plan(const Scenario& scenario);

  const std::vector<TrueHold>& holds() const { return holds_; }
  double duration() const { return duration_; }  ///< s
  /// The places where the board stays for a while, without the hands' tremor: what `at` passes through.
  Pose at(double time) const;  ///< T_rig_board

  /// The board, who carries it, and the second person where the scenario has one, as the scene's last solids.
  void add_to(Scene& scene, double time) const;

 private:
  struct Stop {
    double from = 0, to = 0;  ///< s
    Pose T_rig_board;
  };
  struct Wave {
    double amplitude = 0, frequency = 0, phase = 0;
  };

  PersonMotion(const Scenario& scenario, std::mt19937_64& rng);
  void stay(const Pose& T_rig_board, double duration, double move);
  Pose away() const;
  Eigen::Vector2d walker(double time) const;

  const Scenario* scenario_;
  std::vector<TrueHold> holds_;
  std::vector<Stop> stops_;
  double duration_ = 0;
  std::array<std::array<Wave, 5>, 6> tremor_;  ///< rotation [rad], translation [m], board frame
  std::mt19937_64 looks_;                      ///< of the people: the same clothes at all times
};

}  // namespace ca2
