#include "drivers/lidar/scan_pool.h"

#include <utility>

namespace ca2 {
namespace {

/// Once many scans were held and let go of, this many are enough for the next ones.
constexpr std::size_t most_spare = 4;

}  // namespace

std::shared_ptr<const Scan> ScanPool::keep(Scan& scan) {
  std::unique_ptr<Scan> kept;
  {
    const std::lock_guard lock(spare_->mutex);
    if (!spare_->scans.empty()) {
      kept = std::move(spare_->scans.back());
      spare_->scans.pop_back();
    }
  }
  if (!kept) kept = std::make_unique<Scan>();
  std::swap(*kept, scan);
  return {kept.release(), [spare = spare_](Scan* released) {
            std::unique_ptr<Scan> owned(released);
            const std::lock_guard lock(spare->mutex);
            if (spare->scans.size() < most_spare) spare->scans.push_back(std::move(owned));
          }};
}

}  // namespace ca2
