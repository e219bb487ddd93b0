/// @file The file formats of sensors' data, and writing that a power cut cannot tear.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "core/types/image.h"
#include "core/types/result.h"
#include "core/types/scan.h"

namespace ca2 {

/// A descriptor, for the caller to close. Does not wait for somebody to write to a pipe, as open() does.
Result<int> open_for_reading(const std::filesystem::path& file);

/// The whole file; refuses one larger than `limit` bytes (hostile input must not fill the memory).
Result<std::string> read_text(const std::filesystem::path& file, std::size_t limit = 64u << 20);

/// Writes beside the file, fsyncs, renames over it and fsyncs the directory: old or new, never torn.
Result<void> write_atomically(const std::filesystem::path& file, const std::string& content);

/// Writes a new file and fsyncs it; ErrorCode::cannot_create where there is something of that name already.
/// For the files of a directory that is renamed as a whole.
Result<void> write_new(const std::filesystem::path& file, const std::string& content);
/// The same of content that comes in pieces, none of them kept: `content` gives each to its argument, and
/// stops where that says false.
using PieceSink = std::function<bool(std::string_view)>;
Result<void> write_new(const std::filesystem::path& file,
                       const std::function<void(const PieceSink&)>& content);
/// fsync of a directory: makes the creations and renames in it durable.
Result<void> sync_directory(const std::filesystem::path& directory);

/// PNG, 8 or 16 bits, grey or colour. A palette is resolved (to grey where all its colours are), alpha is
/// dropped, fewer than 8 bits are scaled to 8. At most 30000 x 30000 pixels and 512 MiB of them; whatever is
/// damaged or cut short is ErrorCode::data.
Result<Image> read_png(const std::filesystem::path& file);
/// The writer filters with UP and compresses by run lengths: many times quicker than the default for a few
/// per cent more bytes. Atomic, as write_atomically.
Result<void> write_png(const std::filesystem::path& file, const Image& image);
enum class PngData {
  compressed,  ///< as write_png
  stored,      ///< as it is, in a PNG all the same: for who has no time. Means of pictures are mostly noise
};
/// In memory.
Result<std::string> encode_png(const Image& image, PngData data = PngData::compressed);
/// In pieces, for write_new. ErrorCode::internal for a picture that is none, without a piece.
Result<void> encode_png(const Image& image, PngData data, const PieceSink& sink);
/// `name` is what errors call the picture.
Result<Image> decode_png(std::string_view bytes, const std::string& name);

/// PCD v0.7 (and 0.6), ASCII or binary, any field order, unknown fields and those with COUNT > 1 skipped,
/// organised or not. x y z are required; intensity, ring, column, range and time (t, timestamp; float: s,
/// integer: ns) are read where there. A point with a coordinate that is not finite becomes an all-NaN point.
/// A cloud of 2 to 256 rows without a ring field is taken for a range image: ring is the row, column the
/// column. VIEWPOINT is ignored: points are in the sensor's frame. binary_compressed is refused with a word
/// on how to convert. Errors are ErrorCode::data with the line (binary: the field and point).
Result<Scan> read_pcd(const std::filesystem::path& file);
/// The writer makes binary files, with the fields that the scan knows: x y z intensity range as F 4, ring
/// as U 2, column as U 4, time as I 8 (ns). The comment "# grid RINGS COLUMNS" keeps the sensor's grid, which
/// the returns alone do not tell. Atomic, as write_atomically.
Result<void> write_pcd(const std::filesystem::path& file, const Scan& scan);
Result<Scan> parse_pcd(std::string_view content, const std::string& name);
Result<std::string> encode_pcd(const Scan& scan);
/// Scans one after the other as one cloud, without the arrays that one of them lacks; in pieces of about a
/// megabyte, for write_new. ErrorCode::internal, and no piece, for a scan whose arrays have different
/// lengths.
Result<void> encode_pcd(std::span<const Scan* const> scans, const PieceSink& sink);

}  // namespace ca2
