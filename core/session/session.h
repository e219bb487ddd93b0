/// @file A session: the directory that holds everything one calibration knows (design.md 3.2).
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/session/rig.h"
#include "core/types/image.h"
#include "core/types/result.h"
#include "core/types/scan.h"

namespace ca2 {

/// A pixel of a LiDAR's projection by ID that a person picked on the board.
struct Pick {
  int row = 0;
  int column = 0;
  double radius = 0;  ///< px; 0: the default
};

/// Where the data of one view is. Nothing is loaded.
struct SessionView {
  int id = 0;
  std::filesystem::path directory;
  std::map<std::string, std::filesystem::path> images;  ///< by camera
  std::map<std::string, std::filesystem::path> clouds;  ///< by LiDAR
  std::map<std::string, Pick> picks;                    ///< by LiDAR, from view.yaml
};

struct Session {
  std::filesystem::path directory;
  Rig rig;
  std::vector<SessionView> views;  ///< by rising id
  std::vector<Problem> warnings;   ///< what was odd but did not stop the reading (a view without a pair, ...)
};

/// Reads session.yaml and lists the views: directories whose names are digits. Hidden ones (a view that was
/// being written when the power went) are ignored; views and files with a problem of their own become
/// warnings; a view with neither picture nor cloud of the rig's sensors is left out.
Result<Session> open_session(const std::filesystem::path& directory);

/// Creates the directory with its session.yaml; fails if there is a session already. `created` is the time as
/// the caller wants it shown (core has no clock); empty: not written. Relative paths in the rig are to be
/// relative to the session's directory.
Result<Session> create_session(const std::filesystem::path& directory, const Rig& rig,
                               const std::string& created = {});

/// Adds a view: written to a hidden temporary directory, fsynced and renamed, so that it exists whole or not
/// at all. Never overwrites: ErrorCode::cannot_create where there is a view of that id. `details` is the text
/// of view.yaml; empty: none. Returns the view as open_session would list it.
Result<SessionView> write_view(const std::filesystem::path& session, int id,
                               const std::map<std::string, Image>& images,
                               const std::map<std::string, Scan>& scans, const std::string& details = {});

/// Takes a view out of the session, whole or not at all: it is renamed to a hidden name before it is deleted.
Result<void> remove_view(const SessionView& view);

}  // namespace ca2
