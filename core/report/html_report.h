/// @file A calibration as one self-contained HTML page.
#pragma once

#include <string>
#include <vector>

#include "core/session/calibration.h"

namespace ca2 {

/// A picture of the report: JPEG bytes and what it shows.
struct ReportPicture {
  int view = 0;
  std::string camera, lidar;
  std::string jpeg;
  double near = 0, far = 0;  ///< m: ends of the colour scale
};

struct ReportInput {
  std::string title;
  Calibration calibration;
  std::vector<ReportPicture> pictures;
  std::vector<Problem> problems;  ///< of files that could not be shown
};

/// The page: verdict, transforms both ways, sensors, residuals per view, overlays. No network, no scripts.
std::string html_report(const ReportInput& input);

}  // namespace ca2
