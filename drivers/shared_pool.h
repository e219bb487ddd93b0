/// @file Pictures and scans that are shared, and whose memory comes back when nobody holds them any more.
#pragma once

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace ca2 {

/// A picture or scan has some megabytes; fresh ones from the system cost more time (page faults) than filling
/// them. What is kept may be let go of in any thread, and after the pool's end.
template <class Thing>
class SharedPool {
 public:
  /// Takes what is in `thing` and leaves it the memory of one that was let go of, with what was in that.
  std::shared_ptr<const Thing> keep(Thing& thing) {
    std::unique_ptr<Thing> kept;
    {
      const std::lock_guard lock(spare_->mutex);
      if (!spare_->things.empty()) {
        kept = std::move(spare_->things.back());
        spare_->things.pop_back();
      }
    }
    if (!kept) kept = std::make_unique<Thing>();
    std::swap(*kept, thing);
    return {kept.release(), [spare = spare_](Thing* released) {
              std::unique_ptr<Thing> owned(released);
              const std::lock_guard lock(spare->mutex);
              if (spare->things.size() < most_spare) spare->things.push_back(std::move(owned));
            }};
  }

 private:
  /// Beside the one that is being filled: as a rule one is let go of while the next is filled.
  static constexpr std::size_t most_spare = 1;

  struct Spare {
    std::mutex mutex;
    std::vector<std::unique_ptr<Thing>> things;
  };
  std::shared_ptr<Spare> spare_ = std::make_shared<Spare>();
};

}  // namespace ca2
