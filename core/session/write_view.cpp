#include <fcntl.h>
#include <stdio.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <system_error>

#include "core/io/files.h"
#include "core/io/yaml.h"
#include "core/session/session.h"
#include "core/session/view_files.h"

namespace ca2 {
namespace {

namespace fs = std::filesystem;

/// A hidden directory that is gone afterwards, unless it was renamed.
class HiddenDirectory {
 public:
  explicit HiddenDirectory(fs::path path) : path_(std::move(path)) {}
  ~HiddenDirectory() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  HiddenDirectory(const HiddenDirectory&) = delete;
  HiddenDirectory& operator=(const HiddenDirectory&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

Result<void> write_encoded(const fs::path& file, const Result<std::string>& bytes) {
  if (bytes) return write_new(file, *bytes);
  Error error = bytes.error();
  for (Problem& problem : error.problems) problem.where = file.string();
  return fail(std::move(error));
}

Result<void> write_files(const fs::path& directory, const std::map<std::string, Image>& images,
                         const std::map<std::string, Scan>& scans, const std::string& details) {
  Result<void> done;
  for (const auto& [name, image] : images) {
    if (done) done = write_encoded(directory / (name + ".png"), encode_png(image));
  }
  for (const auto& [name, scan] : scans) {
    if (done) done = write_encoded(directory / (name + ".pcd"), encode_pcd(scan));
  }
  if (done && !details.empty()) done = write_new(directory / "view.yaml", details);
  return done ? sync_directory(directory) : done;
}

/// Renames, but never onto anything: a plain rename would replace an empty directory.
bool rename_to_new(const fs::path& from, const fs::path& to) {
  if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return true;
  // File systems without the flag (NFS, some FUSE): look first.
  if (errno != EINVAL && errno != ENOSYS) return false;
  std::error_code ignored;
  if (fs::exists(to, ignored)) {
    errno = EEXIST;
    return false;
  }
  return ::rename(from.c_str(), to.c_str()) == 0;
}

}  // namespace

Result<SessionView> write_view(const fs::path& session, int id, const std::map<std::string, Image>& images,
                               const std::map<std::string, Scan>& scans, const std::string& details) {
  static std::atomic<unsigned> counter{0};
  const fs::path views = session / "views", directory = views / view_name(id);
  std::set<std::string> cameras, lidars;
  for (const auto& [name, image] : images) cameras.insert(name);
  for (const auto& [name, scan] : scans) lidars.insert(name);
  if (id < 0) return fail(ErrorCode::internal, session.string(), "a view's id is not negative");
  for (const auto& names : {cameras, lidars}) {
    for (const std::string& name : names) {
      if (!valid_sensor_name(name))
        return fail(ErrorCode::internal, "", "'" + name + "' is no sensor's name");
    }
  }
  if (const auto check = parse_yaml(details, (directory / "view.yaml").string(), ErrorCode::internal);
      !check) {
    return fail(check.error());
  }

  std::error_code error;
  if (fs::create_directory(views, error)) {
    if (const auto synced = sync_directory(session); !synced) return fail(synced.error());
  }
  const auto cannot_create = [&](const std::string& reason) {
    return fail(ErrorCode::cannot_create, directory.string(), "cannot be created: " + reason);
  };
  const HiddenDirectory hidden(views / ("." + view_name(id) + "." + std::to_string(::getpid()) + "-" +
                                        std::to_string(counter++) + ".tmp"));
  // Of this name there can only be what a crash left behind long ago.
  fs::remove_all(hidden.path(), error);
  if (!fs::create_directory(hidden.path(), error)) return cannot_create(error.message());
  if (const auto written = write_files(hidden.path(), images, scans, details); !written) {
    return fail(written.error());
  }
  if (!rename_to_new(hidden.path(), directory)) {
    return cannot_create(errno == EEXIST ? "there is a view of that number already"
                                         : std::generic_category().message(errno));
  }
  if (const auto synced = sync_directory(views); !synced) return fail(synced.error());
  std::vector<Problem> ignored;
  return list_view(directory, id, cameras, lidars, ignored);
}

Result<void> remove_view(const SessionView& view) {
  const fs::path views = view.directory.parent_path();
  const HiddenDirectory hidden(views / ("." + view.directory.filename().string() + ".dropped"));
  std::error_code error;
  fs::remove_all(hidden.path(), error);  // what a crash left behind
  fs::rename(view.directory, hidden.path(), error);
  if (error) {
    return fail(ErrorCode::io, view.directory.string(), "cannot be taken out: " + error.message());
  }
  return sync_directory(views);
}

}  // namespace ca2
