/// @file Point clouds in the formats of others.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "core/types/result.h"
#include "core/types/scan.h"

namespace ca2 {

/// A PCD, PLY, CSV (also .txt, .xyz) or NPY file, by its ending. Fields by name where the format has names: x
/// y z are required, intensity and ring are read where they are; a CSV without a header line and an NPY array
/// (N x 3 or more) have x y z and then intensity. Missing returns (not finite) become NaN points.
/// ErrorCode::data with the place.
Result<Scan> read_cloud_file(const std::filesystem::path& file);
/// Does the name end as clouds that read_cloud_file reads do?
bool is_cloud_name(const std::filesystem::path& file);

/// `name` is what errors call the file.
Result<Scan> parse_ply(std::string_view content, const std::string& name);
Result<Scan> parse_cloud_csv(std::string_view content, const std::string& name);
Result<Scan> parse_npy(std::string_view content, const std::string& name);

}  // namespace ca2
