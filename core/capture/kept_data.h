/// @file The pictures and scans that a track keeps: how much they are, and which of them is the oldest.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>

#include "core/types/image.h"
#include "core/types/scan.h"

namespace ca2 {

inline std::size_t bytes_of(const Image& image) {
  return image.bytes.size();
}
inline std::size_t bytes_of(const Scan& scan) {
  return scan.points.size() * sizeof scan.points[0] + scan.intensity.size() * sizeof scan.intensity[0] +
         scan.range.size() * sizeof scan.range[0] + scan.ring.size() * sizeof scan.ring[0] +
         scan.column.size() * sizeof scan.column[0] + scan.time.size() * sizeof scan.time[0];
}

/// Of the observations of a track, oldest first; `data` is their picture or scan, which may have been let go
/// of.
template <class Observation, class Data>
class KeptData {
 public:
  using Member = std::shared_ptr<const Data> Observation::*;
  KeptData(std::deque<Observation>& samples, Member data) : samples_(samples), data_(data) {}

  std::size_t bytes() const {
    std::size_t sum = 0;
    for (const Observation& sample : samples_) sum += sample.*data_ ? bytes_of(*(sample.*data_)) : 0;
    return sum;
  }

  /// nullptr: nothing is kept.
  Observation* oldest() const {
    const auto kept = std::find_if(samples_.begin(), samples_.end(),
                                   [&](const Observation& sample) { return sample.*data_ != nullptr; });
    return kept == samples_.end() ? nullptr : &*kept;
  }

  /// How many bytes that were.
  std::size_t let_go_of_oldest() {
    Observation* const kept = oldest();
    const std::size_t size = bytes_of(*(kept->*data_));
    (kept->*data_).reset();
    return size;
  }

 private:
  std::deque<Observation>& samples_;
  Member data_;
};

}  // namespace ca2
