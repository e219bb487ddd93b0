#include <system_error>

#include "core/io/files.h"
#include "core/session/session.h"
#include "core/session/view_writer.h"

namespace ca2 {

namespace fs = std::filesystem;

Result<SessionView> write_view(const fs::path& session, int id, const std::map<std::string, Image>& images,
                               const std::map<std::string, Scan>& scans, const std::string& details) {
  Result<ViewWriter> writer = ViewWriter::begin(session, id, details);
  if (!writer) return fail(writer.error());
  for (const auto& [name, image] : images) {
    if (const auto added = writer->add(name, image); !added) return fail(added.error());
  }
  for (const auto& [name, scan] : scans) {
    const Scan* const only[] = {&scan};
    if (const auto added = writer->add(name, only); !added) return fail(added.error());
  }
  return writer->finish();
}

Result<void> remove_view(const SessionView& view) {
  const fs::path views = view.directory.parent_path();
  const fs::path hidden = views / ("." + view.directory.filename().string() + ".dropped");
  std::error_code error, ignored;
  fs::remove_all(hidden, error);  // what a crash left behind
  fs::rename(view.directory, hidden, error);
  if (error) {
    return fail(ErrorCode::io, view.directory.string(), "cannot be taken out: " + error.message());
  }
  Result<void> synced = sync_directory(views);
  fs::remove_all(hidden, ignored);
  return synced;
}

}  // namespace ca2
