/// @file What one LiDAR has held for the board lately, and which of it stands still.
#pragma once

#include <deque>
#include <vector>

#include "core/capture/kept_data.h"
#include "core/capture/observation.h"
#include "core/capture/rhythm.h"

namespace ca2 {

/// A hypothesis that is in the scans of a hold.
struct LidarHold {
  std::size_t sight = 0;  ///< of the newest of the scans
  double motion = 0;      ///< m, of its plane over these scans
  double presence = 0;    ///< share of the scans it was found in
  double novelty = 0;     ///< mean share of it that lies before the background; NaN: not known
};

class LidarTrack {
 public:
  void add(const LidarObservation& observation);
  /// ns: what is older is forgotten.
  void look_back(std::int64_t history) { history_ = history; }

  /// Scans that were measured between these times as a whole, oldest first; released ones are among them.
  std::vector<const LidarObservation*> within(std::int64_t first, std::int64_t last) const;
  /// The newest of the scans' hypotheses, followed back through the others.
  static std::vector<LidarHold> follow(const std::vector<const LidarObservation*>& scans);

  /// Scans that began before are in no view any more: only what was found in them is kept. Never the newest.
  void release_before(std::int64_t time);

  KeptData<LidarObservation, Scan> kept() { return {samples_, &LidarObservation::scan}; }
  /// A scan of a hold was let go of for want of room.
  void count_let_go() { ++let_go_; }
  std::uint64_t let_go() const { return let_go_; }

  const LidarObservation* newest() const { return samples_.empty() ? nullptr : &samples_.back(); }
  const Rhythm& rhythm() const { return rhythm_; }
  /// ns: what a revolution takes.
  std::int64_t period() const { return rhythm_.period().value_or(100'000'000); }
  std::uint64_t frames() const { return frames_; }
  std::uint64_t shed() const { return shed_; }

 private:
  bool begins_since(std::int64_t time, const LidarObservation& sample) const;  ///< as far as clocks agree

  std::int64_t history_ = 2'000'000'000;
  std::deque<LidarObservation> samples_;  ///< searched scans, oldest first
  Rhythm rhythm_;
  std::uint64_t frames_ = 0, shed_ = 0, let_go_ = 0;
};

/// How far two planes are apart at the places where they were seen, m.
double plane_motion(const LidarSight& a, const LidarSight& b);

}  // namespace ca2
