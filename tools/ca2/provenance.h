/// @file What a calibration rests on: sensors' identities and the hashes of every file it was made from.
#pragma once

#include <vector>

#include "core/export/exporter.h"
#include "core/session/session.h"

namespace ca2 {

/// Names, ids, serial numbers and firmware of the sensors as far as the rig and their metadata tell, and the
/// SHA-256 of session.yaml, the files it names, and those of every view. Files that cannot be read are named
/// as such.
std::vector<ProvenanceEntry> provenance(const Session& session);

/// The last component of the session's path, also for "." and paths with a slash at the end.
std::string session_name(const std::filesystem::path& directory);

}  // namespace ca2
