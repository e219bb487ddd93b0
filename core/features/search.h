/// @file The search for the board in a session's files, one by one, on all cores.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/features/extract.h"
#include "core/features/feature_cache.h"
#include "core/types/image.h"
#include "core/types/scan.h"

namespace ca2 {

/// One file of one view, and what was found in it.
struct SensorFile {
  std::size_t view = 0;  ///< index in Session::views
  std::string sensor;
  std::filesystem::path path;
  bool is_image = false;                 ///< a camera's picture; else a LiDAR's cloud
  const Pick* pick = nullptr;            ///< the session's
  std::optional<std::uint64_t> content;  ///< ContentDigest of the file, where it is known
  ImageFeatures image;
  std::vector<LidarSight> cloud;
  std::optional<Error> error;  ///< the file cannot be used
  bool cached = false;

  bool sees_board() const { return !error && (is_image ? !image.corners.empty() : !cloud.empty()); }
};

/// read_pcd, and a cloud without a single return is ErrorCode::data.
Result<Scan> read_cloud(const std::filesystem::path& file);

/// The files of the views with the `wanted` ids (empty: of all), by view, cameras before LiDARs, by name.
/// ErrorCode::usage for an id that is not there, ErrorCode::data where there is no file at all.
Result<std::vector<SensorFile>> list_files(const Session& session, const std::vector<int>& wanted);

/// Fill in what the file shows, of a picture or scan that is in memory: the same as from the file.
void search_image(SensorFile& file, const Board& board, const Image& image);
void search_cloud(SensorFile& file, const Board& board, const Scan& scan);

/// Leaves what was found in the session's cache, as `search` does.
void keep_found(const Session& session, const std::vector<SensorFile>& files);

/// What the searched files of one view (at least one) show together. Fails as extract_view does.
Result<ViewSights> view_sights(const Session& session, std::vector<SensorFile> files);

/// ContentDigest of each file, from the cache where it knows; those that cannot be read have none.
void add_contents(const Session& session, std::vector<SensorFile>& files, bool cache);

/// Fills in what each file shows, from the cache where it knows.
void search(const Session& session, std::vector<SensorFile>& files, const ExtractOptions& options);

}  // namespace ca2
