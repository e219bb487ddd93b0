/// @file The pictures of a report, drawn on all cores.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/report/html_report.h"

namespace ca2 {

struct ReportPictures {
  std::vector<ReportPicture> pictures;
  std::string cloud;              ///< JPEG
  std::string ply;                ///< of the same view
  Image overlay;                  ///< of the first view, at full size
  std::vector<Problem> problems;  ///< files that could not be drawn
};

/// Every view of the session that has a picture and a cloud of a calibrated pair, used or not. `progress` is
/// called from the calling thread only.
ReportPictures draw_pictures(const Session& session, const Calibration& calibration, const Evidence* evidence,
                             const std::function<void(int done, int total)>& progress);

}  // namespace ca2
