/// @file What one camera has seen of the board lately, and since when it stands still.
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "core/capture/kept_data.h"
#include "core/capture/observation.h"
#include "core/capture/rhythm.h"

namespace ca2 {

/// The board in one camera over the last seconds.
struct CameraStillness {
  std::int64_t since = 0;   ///< ns: the first picture from which on the corners keep within `limit`
  std::int64_t newest = 0;  ///< ns: the last picture with the board
  double motion = 0;        ///< px, of the corners over the dwell; a slow camera's against the picture before
  double limit = 0;         ///< px
};

/// By corner id; nothing: not seen.
using CornerPixels = std::vector<std::optional<Eigen::Vector2d>>;

class CameraTrack {
 public:
  explicit CameraTrack(const Board& board);

  void add(const CameraObservation& observation);
  /// ns: what is older is forgotten.
  void look_back(std::int64_t history) { history_ = history; }

  /// Its pictures come so seldom that nobody can tell by them whether the board is still.
  bool too_slow() const;

  /// Nothing where the board is not in sight at `now`, or the camera is too slow. `board_motion` m and
  /// `dwell` s as in CaptureOptions.
  std::optional<CameraStillness> stillness(std::int64_t now, double board_motion, double dwell) const;

  /// Pictures with the board from `first` to `last`, oldest first; released ones are among them.
  std::vector<const CameraObservation*> between(std::int64_t first, std::int64_t last) const;
  /// Mean place of every corner that most of these pictures show, its covariance that of one picture's
  /// divided by their number; ids as in the newest one.
  std::vector<Corner> mean_corners(const std::vector<const CameraObservation*>& pictures) const;

  /// Pictures taken before are in no view any more: only what was found in them is kept.
  void release_before(std::int64_t time);

  KeptData<CameraObservation, Image> kept() { return {samples_, &CameraObservation::image}; }
  /// A picture of a hold was let go of for want of room.
  void count_let_go() { ++let_go_; }
  std::uint64_t let_go() const { return let_go_; }

  const CameraObservation* newest() const { return samples_.empty() ? nullptr : &samples_.back(); }
  const Rhythm& rhythm() const { return rhythm_; }
  std::uint64_t frames() const { return frames_; }
  std::uint64_t shed() const { return shed_; }

 private:
  CornerPixels by_id(const std::vector<Corner>& corners) const;
  void label_as_before(std::vector<Corner>& corners, CornerPixels& pixels) const;
  std::int64_t longest_gap() const;
  double pixels_per_metre(const std::vector<Corner>& corners) const;
  std::int64_t settled(const CameraStillness& still) const;

  std::vector<Eigen::Vector2d> places_;  ///< of the corners by id, m
  bool half_turn_ambiguous_;
  std::int64_t history_ = 2'000'000'000;
  /// Searched pictures, oldest first; ids of an ambiguous board agree with those of the picture before.
  std::deque<CameraObservation> samples_;
  std::deque<CornerPixels> pixels_;  ///< of each sample
  Rhythm rhythm_;
  std::uint64_t frames_ = 0, shed_ = 0, let_go_ = 0;
};

}  // namespace ca2
