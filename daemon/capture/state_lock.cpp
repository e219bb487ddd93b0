#include "daemon/capture/state_lock.h"

#include <fcntl.h>
#include <sys/file.h>

#include <cerrno>

namespace ca2 {

Result<UniqueFd> lock_state(const std::filesystem::path& directory) {
  std::error_code ignored;
  std::filesystem::create_directories(directory, ignored);
  // The directory itself: a file in it would need room on the disk.
  UniqueFd held(::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (held.valid() && ::flock(held.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    return fail(ErrorCode::unavailable, directory.string(), "another ca2d keeps its sessions there",
                "stop it, or give this one another state.directory");
  }
  return held;
}

}  // namespace ca2
