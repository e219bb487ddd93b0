/// @file A recording's folder of pictures: <utc_ns>.png, which the source `image_folder` reads.
#pragma once

#include <cstdint>
#include <filesystem>

#include "core/types/image.h"
#include "core/types/result.h"

namespace ca2 {

/// Writes a picture beside and renames it, so that who reads the folder meanwhile sees whole ones only. Not
/// synced to the disk: a power cut may cost the last seconds of a recording, not its speed.
Result<void> save_picture(const std::filesystem::path& folder, std::int64_t time, const Image& image);

}  // namespace ca2
