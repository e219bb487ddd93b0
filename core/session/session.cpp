#include "core/session/session.h"

#include <algorithm>
#include <charconv>

#include "ca2_version.h"
#include "core/io/files.h"
#include "core/io/yaml_text.h"
#include "core/session/view_files.h"

namespace ca2 {
namespace {

namespace fs = std::filesystem;

template <class Value>
std::set<std::string> keys_of(const std::map<std::string, Value>& map) {
  std::set<std::string> keys;
  for (const auto& [key, value] : map) keys.insert(key);
  return keys;
}

/// The id that a directory's name spells; nothing if it is not all digits, or too many of them.
std::optional<int> view_id(const std::string& name) {
  int id = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), id);
  const bool digits = name.front() >= '0' && name.front() <= '9' && end == name.data() + name.size();
  return digits && error == std::errc() ? std::optional(id) : std::nullopt;
}

/// What views there are, by id; the same id in two spellings is one view and a warning.
std::map<int, fs::path> find_views(const fs::path& directory, std::vector<Problem>& warnings) {
  std::error_code error;
  std::vector<fs::path> entries;
  for (fs::directory_iterator at(directory, error), end; !error && at != end; at.increment(error)) {
    if (at->path().filename().string().front() != '.') entries.push_back(at->path());
  }
  if (error && error != std::errc::no_such_file_or_directory) {
    warnings.push_back({directory.string(), "cannot be listed: " + error.message(), {}});
  }
  std::sort(entries.begin(), entries.end());
  std::map<int, fs::path> views;
  for (const fs::path& entry : entries) {
    const auto id = view_id(entry.filename().string());
    std::error_code ignored;
    if (!id || !fs::is_directory(entry, ignored)) {
      warnings.push_back({entry.string(), "is not a view", "views are directories named by digits"});
    } else if (!views.emplace(*id, entry).second) {
      warnings.push_back({entry.string(), "there is a view " + std::to_string(*id) + " already", "not used"});
    }
  }
  return views;
}

/// Keeps the view if there is anything in it; says what is missing.
void add_view(Session& session, SessionView view) {
  const std::string where = view.directory.string();
  if (view.images.empty() && view.clouds.empty()) {
    session.warnings.push_back({where, "the view has neither pictures nor clouds", "not used"});
    return;
  }
  if (view.images.empty() && !session.rig.cameras.empty()) {
    session.warnings.push_back({where, "the view has no picture of any camera", {}});
  }
  if (view.clouds.empty() && !session.rig.lidars.empty()) {
    session.warnings.push_back({where, "the view has no cloud of any lidar", {}});
  }
  session.views.push_back(std::move(view));
}

}  // namespace

Result<Session> open_session(const fs::path& directory) {
  std::error_code error;
  if (!fs::exists(directory, error))
    return fail(ErrorCode::io, directory.string(), "there is no such directory");
  const fs::path file = directory / "session.yaml";
  if (!fs::exists(file, error)) {
    return fail(ErrorCode::io, directory.string(), "has no session.yaml", "is this a session's directory?");
  }
  Result<Rig> rig = read_rig(file, {"software", "created"});
  if (!rig) return fail(rig.error());
  Session session;
  session.directory = directory;
  session.rig = std::move(*rig);
  const std::set<std::string> cameras = keys_of(session.rig.cameras), lidars = keys_of(session.rig.lidars);
  for (const auto& [id, path] : find_views(directory / "views", session.warnings)) {
    add_view(session, list_view(path, id, cameras, lidars, session.warnings));
  }
  return session;
}

Result<Session> create_session(const fs::path& directory, const Rig& rig, const std::string& created) {
  const fs::path file = directory / "session.yaml";
  std::string text = write_rig(rig) + "software: " + yaml_string("ca2 " CA2_VERSION) + "\n";
  if (!created.empty()) text += "created: " + yaml_string(created) + "\n";
  // What is written must be readable again: a rig made by a program may have never been through parse_rig.
  if (const auto check = parse_rig(text, file, {"software", "created"}); !check) return fail(check.error());
  std::error_code error;
  if (fs::exists(file, error)) {
    return fail(ErrorCode::cannot_create, file.string(), "there is a session already",
                "choose another directory");
  }
  fs::create_directories(directory / "views", error);
  if (error)
    return fail(ErrorCode::cannot_create, directory.string(), "cannot be created: " + error.message());
  if (const auto written = write_atomically(file, text); !written) return fail(written.error());
  return open_session(directory);
}

}  // namespace ca2
