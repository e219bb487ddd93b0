/// @file What a LiDAR sees when nobody is in the way.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/types/scan.h"

namespace ca2 {

/// The farthest range of every direction over the last 30 to 60 seconds: who holds a board stands in front
/// of something. It needs no empty room to begin with: as soon as somebody moves on, what was behind counts.
/// Of scans in quick succession it takes some.
class Background {
 public:
  void add(const Scan& scan, std::int64_t time);

  /// Share of the returns (indices of the scan) that lie clearly before the background; NaN while it is not
  /// known: in the first second.
  double before(const Scan& scan, std::span<const std::uint32_t> returns) const;

 private:
  bool known() const;

  std::vector<float> farthest_;                      ///< m^2, of this epoch; 0: nothing came back
  std::vector<float> previous_;                      ///< of the epoch before
  std::int64_t first_ = 0, newest_ = 0, epoch_ = 0;  ///< ns
  bool empty_ = true;
};

}  // namespace ca2
