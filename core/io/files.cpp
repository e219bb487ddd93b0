#include "core/io/files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <system_error>

namespace ca2 {
namespace {

namespace fs = std::filesystem;

/// An open file descriptor, closed once.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  bool valid() const { return fd_ >= 0; }
  int get() const { return fd_; }
  /// Closes now; errors of a delayed write (NFS, quota) come out here.
  bool close() {
    const int fd = fd_;
    fd_ = -1;
    return ::close(fd) == 0;
  }

 private:
  int fd_;
};

tl::unexpected<Error> system_failure(ErrorCode code, const fs::path& file, const std::string& action) {
  const int number = errno;
  if (number == EACCES || number == EPERM) code = ErrorCode::no_permission;
  return fail(code, file.string(), action + ": " + std::generic_category().message(number));
}

bool write_all(int fd, std::string_view content) {
  std::size_t done = 0;
  while (done < content.size()) {
    const ssize_t n = ::write(fd, content.data() + done, content.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return false;
    done += static_cast<std::size_t>(n);
  }
  return true;
}

/// Creates `file`, which must not exist, with the content on the disk.
Result<void> create_durably(const fs::path& file, const std::function<void(const PieceSink&)>& content) {
  Descriptor out(::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0644));
  if (!out.valid()) return system_failure(ErrorCode::cannot_create, file, "cannot be created");
  bool written = true;
  content([&](std::string_view piece) { return written = written && write_all(out.get(), piece); });
  if (!written || ::fsync(out.get()) != 0 || !out.close()) {
    const auto failure = system_failure(ErrorCode::io, file, "writing failed");
    ::unlink(file.c_str());
    return failure;
  }
  return {};
}

std::function<void(const PieceSink&)> in_one_piece(const std::string& content) {
  return [&content](const PieceSink& sink) { sink(content); };
}

/// A hidden name beside the file that no other thread or live process uses.
fs::path temporary_beside(const fs::path& file) {
  static std::atomic<unsigned> counter{0};
  return file.parent_path() / ("." + file.filename().string() + "." + std::to_string(::getpid()) + "-" +
                               std::to_string(counter++) + ".tmp");
}

}  // namespace

Result<int> open_for_reading(const fs::path& file) {
  const int fd = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0) return system_failure(ErrorCode::io, file, "cannot be opened");
  // Only the opening must not wait: a pipe with a writer is read as usual.
  ::fcntl(fd, F_SETFL, ::fcntl(fd, F_GETFL) & ~O_NONBLOCK);
  return fd;
}

Result<std::string> read_text(const fs::path& file, std::size_t limit) {
  const Result<int> opened = open_for_reading(file);
  if (!opened) return fail(opened.error());
  const Descriptor in(*opened);
  struct stat status {};
  if (::fstat(in.get(), &status) != 0) return system_failure(ErrorCode::io, file, "cannot be read");
  if (S_ISDIR(status.st_mode)) return fail(ErrorCode::io, file.string(), "is a directory, not a file");
  const auto too_large = [&] {
    return fail(ErrorCode::data, file.string(), "is larger than " + std::to_string(limit) + " bytes");
  };
  std::string content;
  // The size is a hint only: pipes and /proc have none, and a file may grow while it is read.
  std::size_t expected = 0;
  if (S_ISREG(status.st_mode)) expected = static_cast<std::size_t>(status.st_size);
  if (expected > limit) return too_large();
  std::size_t size = 0;
  while (true) {
    if (size == content.size()) content.resize(std::min(limit, std::max(2 * size, expected) + 4096) + 1);
    const ssize_t n = ::read(in.get(), content.data() + size, content.size() - size);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return system_failure(ErrorCode::io, file, "reading failed");
    if (n == 0) break;
    size += static_cast<std::size_t>(n);
    if (size > limit) return too_large();
  }
  if (size == 0 && S_ISFIFO(status.st_mode)) {
    return fail(ErrorCode::io, file.string(), "is a pipe that nobody writes to", "name a file");
  }
  content.resize(size);
  return content;
}

Result<void> write_new(const fs::path& file, const std::string& content) {
  return create_durably(file, in_one_piece(content));
}

Result<void> write_new(const fs::path& file, const std::function<void(const PieceSink&)>& content) {
  return create_durably(file, content);
}

Result<void> sync_directory(const fs::path& directory) {
  const Descriptor fd(::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!fd.valid()) return system_failure(ErrorCode::io, directory, "cannot be opened");
  // Some network and FUSE file systems know no fsync of a directory; they order renames themselves.
  if (::fsync(fd.get()) != 0 && errno != EINVAL && errno != ENOTSUP) {
    return system_failure(ErrorCode::io, directory, "fsync failed");
  }
  return {};
}

Result<void> write_atomically(const fs::path& file, const std::string& content) {
  const fs::path temporary = temporary_beside(file);
  // Of this name there can only be what a crash left behind long ago.
  ::unlink(temporary.c_str());
  const Result<void> written = create_durably(temporary, in_one_piece(content));
  if (!written) {
    // The person knows the file, not the temporary.
    Error error = written.error();
    for (Problem& problem : error.problems) problem.where = file.string();
    return fail(std::move(error));
  }
  if (::rename(temporary.c_str(), file.c_str()) != 0) {
    const auto failure = system_failure(ErrorCode::cannot_create, file, "cannot be replaced");
    ::unlink(temporary.c_str());
    return failure;
  }
  return sync_directory(file.has_parent_path() ? file.parent_path() : fs::path("."));
}

}  // namespace ca2
