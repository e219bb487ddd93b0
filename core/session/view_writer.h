/// @file A view that is written sensor by sensor, so that no more than one sensor's data need be in memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <set>
#include <span>
#include <string>

#include "core/io/files.h"
#include "core/session/session.h"

namespace ca2 {

/// Writes into a hidden directory that becomes the view with finish(), and is gone without it.
class ViewWriter {
 public:
  /// `details` is the text of view.yaml; empty: none.
  static Result<ViewWriter> begin(const std::filesystem::path& session, int id, std::string details);
  ViewWriter(ViewWriter&&) noexcept;
  ViewWriter& operator=(ViewWriter&&) = delete;
  ~ViewWriter();

  /// Return the ContentDigest of the file.
  Result<std::uint64_t> add(const std::string& camera, const Image& image,
                            PngData data = PngData::compressed);
  /// All of the scans as one cloud.
  Result<std::uint64_t> add(const std::string& lidar, std::span<const Scan* const> scans);
  /// As write_view; nothing may be added any more.
  Result<SessionView> finish();

 private:
  ViewWriter(std::filesystem::path views, int id, std::string details);
  Result<std::uint64_t> add(const std::string& sensor, const char* ending,
                            const std::function<Result<void>(const PieceSink&)>& encode);

  std::filesystem::path views_, hidden_;
  int id_;
  std::string details_;
  std::set<std::string> cameras_, lidars_;
};

}  // namespace ca2
