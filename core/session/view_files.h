/// @file The directory of one view: what is in it.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "core/session/session.h"

namespace ca2 {

/// "000012"
std::string view_name(int id);

/// Lists the files of the named sensors and reads view.yaml; oddities become warnings.
SessionView list_view(const std::filesystem::path& directory, int id, const std::set<std::string>& cameras,
                      const std::set<std::string>& lidars, std::vector<Problem>& warnings);

}  // namespace ca2
