/// @file A rig from Kalibr's files: its target and its camchain.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/session/rig.h"
#include "core/types/result.h"

namespace ca2 {

/// The board of Kalibr's target file: aprilgrid, or checkerboard with equal spacings. Its plate is not known:
/// without an outline. ErrorCode::config with every problem.
Result<Board> read_kalibr_target(const std::filesystem::path& file);

/// The cameras of a camchain under their names there (cam0, ...), with intrinsics and, of T_cn_cnm1, first
/// guesses of where they sit to each other; and LiDARs of these names. ErrorCode::config.
Result<Rig> kalibr_rig(const std::filesystem::path& target, const std::filesystem::path& camchain,
                       const std::vector<std::string>& lidars);

}  // namespace ca2
