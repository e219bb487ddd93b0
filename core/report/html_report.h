/// @file A session as one self-contained HTML page: its answer, what it rests on, and what is missing.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/report/evidence.h"
#include "core/session/calibration.h"
#include "core/session/session.h"

namespace ca2 {

/// Pictures of a view, as JPEG bytes.
struct ReportPicture {
  int view = 0;
  std::string camera, lidar;
  std::string overlay;        ///< LiDAR points by range
  std::string residuals;      ///< the board by residual; empty: not known
  double near = 0, far = 0;   ///< m: ends of the overlay's colours
  double residual_scale = 0;  ///< m: ends of the residuals' colours
  double magnified = 0;       ///< of the corners' errors
};

struct ReportInput {
  std::string title;
  std::vector<std::string> missing;        ///< what stands between this session and an answer, for a person
  std::optional<Session> session;          ///< none: it cannot be opened
  std::optional<Calibration> calibration;  ///< none: not solved
  std::optional<Problem> outdated;         ///< the session is not what the answer was made of any more
  std::optional<Evidence> evidence;
  std::vector<ReportPicture> pictures;
  std::string cloud;              ///< JPEG: the scan in the camera's colours; empty: none
  std::vector<Problem> problems;  ///< of files
  std::vector<std::pair<std::string, std::string>> provenance;  ///< subject and value
};

/// No network, no scripts: switches are style sheets'.
std::string html_report(const ReportInput& input);

}  // namespace ca2
