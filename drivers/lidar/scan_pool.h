/// @file Scans that are shared, and whose memory comes back when nobody holds them any more.
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "core/types/scan.h"

namespace ca2 {

/// A scan has some megabytes; fresh ones from the system cost more time (page faults) than decoding into
/// them. What is kept may be let go of in any thread, and after the pool's end.
class ScanPool {
 public:
  /// Takes what is in `scan` and leaves it the memory of a scan that was let go of.
  std::shared_ptr<const Scan> keep(Scan& scan);

 private:
  struct Spare {
    std::mutex mutex;
    std::vector<std::unique_ptr<Scan>> scans;
  };
  std::shared_ptr<Spare> spare_ = std::make_shared<Spare>();
};

}  // namespace ca2
