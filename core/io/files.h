/// @file The file formats of sensors' data, and writing that a power cut cannot tear.
#pragma once

#include <filesystem>
#include <string>

#include "core/types/image.h"
#include "core/types/result.h"
#include "core/types/scan.h"

namespace ca2 {

/// The whole file; refuses one larger than `limit` bytes (hostile input must not fill the memory).
Result<std::string> read_text(const std::filesystem::path& file, std::size_t limit = 64u << 20);

/// Writes beside the file, fsyncs, renames over it and fsyncs the directory: old or new, never torn.
Result<void> write_atomically(const std::filesystem::path& file, const std::string& content);

/// PNG, 8 or 16 bits, grey or colour (palette and alpha are resolved). The writer filters with UP and
/// compresses fast: 20 times quicker than the default for 2 % more bytes.
Result<Image> read_png(const std::filesystem::path& file);
Result<void> write_png(const std::filesystem::path& file, const Image& image);
/// In memory, for reports.
Result<std::string> encode_png(const Image& image);

/// PCD v0.7 (and 0.6), ASCII or binary, any field order, unknown fields skipped, organised or not. x y z are
/// required; intensity, ring, column, range and time (t, timestamp; s or ns by their type) are read where
/// there. binary_compressed is refused with a word on how to convert. The writer makes binary files.
Result<Scan> read_pcd(const std::filesystem::path& file);
Result<void> write_pcd(const std::filesystem::path& file, const Scan& scan);

}  // namespace ca2
