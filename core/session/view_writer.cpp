#include "core/session/view_writer.h"

#include <fcntl.h>
#include <stdio.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <system_error>

#include "core/io/content_digest.h"
#include "core/io/files.h"
#include "core/io/yaml.h"
#include "core/session/view_files.h"

namespace ca2 {
namespace {

namespace fs = std::filesystem;

Result<void> check_name(const std::string& name) {
  if (valid_sensor_name(name)) return {};
  return fail(ErrorCode::internal, "", "'" + name + "' is no sensor's name");
}

tl::unexpected<Error> named(Error error, const fs::path& file) {
  for (Problem& problem : error.problems) problem.where = file.string();
  return fail(std::move(error));
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

tl::unexpected<Error> cannot_create(const fs::path& directory, const std::string& reason) {
  return fail(ErrorCode::cannot_create, directory.string(), "cannot be created: " + reason);
}

}  // namespace

ViewWriter::ViewWriter(fs::path views, int id, std::string details)
    : views_(std::move(views)), id_(id), details_(std::move(details)) {
  static std::atomic<unsigned> counter{0};
  hidden_ = views_ / ("." + view_name(id) + "." + std::to_string(::getpid()) + "-" +
                      std::to_string(counter++) + ".tmp");
}

ViewWriter::ViewWriter(ViewWriter&& other) noexcept
    : views_(std::move(other.views_)),
      hidden_(std::exchange(other.hidden_, {})),
      id_(other.id_),
      details_(std::move(other.details_)),
      cameras_(std::move(other.cameras_)),
      lidars_(std::move(other.lidars_)) {}

ViewWriter::~ViewWriter() {
  std::error_code ignored;
  if (!hidden_.empty()) fs::remove_all(hidden_, ignored);
}

Result<ViewWriter> ViewWriter::begin(const fs::path& session, int id, std::string details) {
  if (id < 0) return fail(ErrorCode::internal, session.string(), "a view's id is not negative");
  const fs::path views = session / "views", directory = views / view_name(id);
  if (const auto check = parse_yaml(details, (directory / "view.yaml").string(), ErrorCode::internal);
      !check) {
    return fail(check.error());
  }
  std::error_code error;
  if (fs::create_directory(views, error)) {
    if (const auto synced = sync_directory(session); !synced) return fail(synced.error());
  }
  ViewWriter writer(views, id, std::move(details));
  // Of this name there can only be what a crash left behind long ago.
  fs::remove_all(writer.hidden_, error);
  if (!fs::create_directory(writer.hidden_, error)) return cannot_create(directory, error.message());
  return writer;
}

Result<std::uint64_t> ViewWriter::add(const std::string& camera, const Image& image, PngData data) {
  const auto digest =
      add(camera, ".png", [&](const PieceSink& sink) { return encode_png(image, data, sink); });
  if (digest) cameras_.insert(camera);
  return digest;
}

Result<std::uint64_t> ViewWriter::add(const std::string& lidar, std::span<const Scan* const> scans) {
  const auto digest = add(lidar, ".pcd", [&](const PieceSink& sink) { return encode_pcd(scans, sink); });
  if (digest) lidars_.insert(lidar);
  return digest;
}

Result<std::uint64_t> ViewWriter::add(const std::string& sensor, const char* ending,
                                      const std::function<Result<void>(const PieceSink&)>& encode) {
  if (const auto good = check_name(sensor); !good) return fail(good.error());
  const fs::path file = hidden_ / (sensor + ending);
  ContentDigest digest;
  Result<void> encoded;
  const auto written = write_new(file, [&](const PieceSink& sink) {
    encoded = encode([&](std::string_view piece) {
      digest.add(piece);
      return sink(piece);
    });
  });
  if (!written) return fail(written.error());
  if (!encoded) return named(encoded.error(), file);
  return digest.value();
}

Result<SessionView> ViewWriter::finish() {
  const fs::path directory = views_ / view_name(id_);
  if (!details_.empty()) {
    if (const auto written = write_new(hidden_ / "view.yaml", details_); !written) {
      return fail(written.error());
    }
  }
  if (const auto synced = sync_directory(hidden_); !synced) return fail(synced.error());
  if (!rename_to_new(hidden_, directory)) {
    return cannot_create(directory, errno == EEXIST ? "there is a view of that number already"
                                                    : std::generic_category().message(errno));
  }
  hidden_.clear();
  if (const auto synced = sync_directory(views_); !synced) return fail(synced.error());
  std::vector<Problem> ignored;
  return list_view(directory, id_, cameras_, lidars_, ignored);
}

}  // namespace ca2
