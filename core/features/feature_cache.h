/// @file Features kept beside the session's data, so that a second solve does not search again.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/board/board.h"
#include "core/features/sights.h"

namespace ca2 {

/// What a picture gave: the corners, whatever the intrinsics, and the size of the picture.
struct ImageFeatures {
  int width = 0, height = 0;  ///< px
  std::vector<Corner> corners;
};

/// ContentDigest of a file; nothing where it cannot be read.
std::optional<std::uint64_t> content_of(const std::filesystem::path& data);

/// Files under SESSION/cache: derived, safe to delete, never trusted further than their key and checksum go.
/// The key is the content of the data file and every setting that shapes the features. The content is taken
/// as unchanged while the file's size and time of change are, so that a second solve reads features only.
class FeatureCache {
 public:
  /// `settings` describes the board and the versions of the searches; an empty `directory` caches nothing.
  FeatureCache(std::filesystem::path directory, const std::string& settings);

  std::optional<ImageFeatures> load_image(const std::string& name, const std::filesystem::path& data) const;
  std::optional<std::vector<LidarSight>> load_cloud(const std::string& name,
                                                    const std::filesystem::path& data) const;
  /// `content`: ContentDigest of the file, where it is known; otherwise the file is read for it. Failures to
  /// write are not errors: the next solve is slower, nothing else.
  void store_image(const std::string& name, const std::filesystem::path& data,
                   std::optional<std::uint64_t> content, const ImageFeatures& features) const;
  void store_cloud(const std::string& name, const std::filesystem::path& data,
                   std::optional<std::uint64_t> content, const std::vector<LidarSight>& sights) const;

  /// ContentDigest of the data file, as it was stored with the features; nothing where it is not known any
  /// more.
  std::optional<std::uint64_t> content(const std::string& name, const std::filesystem::path& data) const;

 private:
  std::optional<std::string> load(const std::string& name, const std::filesystem::path& data) const;
  void store(const std::string& name, const std::filesystem::path& data, std::optional<std::uint64_t> content,
             const std::string& payload) const;

  std::filesystem::path directory_;
  std::uint64_t settings_ = 0;
};

}  // namespace ca2
