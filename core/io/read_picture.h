/// @file Pictures of either format.
#pragma once

#include <filesystem>

#include "core/types/image.h"
#include "core/types/result.h"

namespace ca2 {

/// A PNG or a JPEG file, told apart by what it begins with.
Result<Image> read_picture(const std::filesystem::path& file);
/// Does the name end as pictures that read_picture reads do?
bool is_picture_name(const std::filesystem::path& file);

}  // namespace ca2
