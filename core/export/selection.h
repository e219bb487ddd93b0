/// @file Which transforms a format gets, and words that every format writes.
#pragma once

#include <string>
#include <vector>

#include "core/export/exporter.h"

namespace ca2 {

/// A transform between frames as it goes into a file.
struct ExportTransform {
  std::string parent, child;  ///< frames
  Connection connection;
};

/// The transforms from one root to each child (a frame has one parent in a tree of frames): what --parent and
/// --child name, or else `root` and `children`, which are sensors or frames. The root itself is no child.
Result<std::vector<ExportTransform>> select_tree(const ExportRequest& request, const std::string& root,
                                                 const std::vector<std::string>& children);

/// The same with the first camera as root and all other sensors as children.
Result<std::vector<ExportTransform>> select_default_tree(const ExportRequest& request);

/// A camera and where its --child frames are in it (default: the LiDARs).
struct ExportCamera {
  std::string name;
  const CalibratedCamera* calibrated = nullptr;
  std::vector<ExportTransform> transforms;
};
/// The camera that --parent names, or all. ErrorCode::refused where --parent is no camera or a picture's size
/// is not known; `format` is named in the message.
Result<std::vector<ExportCamera>> select_cameras(const ExportRequest& request, const std::string& format);

/// Names of the LiDARs, in order.
std::vector<std::string> lidar_names(const Calibration& calibration);

/// ErrorCode::refused where a name has letters that tf2 and its launch files do not carry unharmed.
Result<void> check_frame_names(const std::vector<ExportTransform>& transforms);

/// What is in the file, by whom, how good: lines without a comment mark, safe in comments of any format.
std::vector<std::string> header_lines(const ExportRequest& request);
/// "sigma 1.2 mm, 0.8 mrad"; empty for a transform that only known ones lead to.
std::string sigma_text(const Connection& connection);
/// header_lines, each after "# ".
std::string hash_comments(const ExportRequest& request);

/// "what" is beyond `format`: an error that is its own explanation.
tl::unexpected<Error> inexpressible(const std::string& format, const std::string& what,
                                    const std::string& hint);

}  // namespace ca2
