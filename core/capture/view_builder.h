/// @file What is stored of a hold: mean pictures, gathered returns, and what is worth noting.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/capture/observation.h"
#include "core/session/session.h"

namespace ca2 {

/// The mean of pictures of one size and kind: 16 bits per channel, of which the mean of n 8-bit pictures
/// fills 8 and half of log2(n). A single picture stays as it is.
Image mean_image(const std::vector<const CameraObservation*>& pictures);

/// All returns of the scans, as far as a search for the board asks for them: without ranges and times. Each
/// scan is let go of once it is copied; an array that one of them lacks is left out.
Scan gathered_scan(std::vector<std::shared_ptr<const Scan>> scans);

/// What view.yaml says beside the data.
struct ViewDetails {
  bool automatic = true;
  std::map<std::string, std::vector<std::int64_t>> stamps;  ///< ns UTC of every picture and scan, by sensor
  std::map<std::string, std::size_t> pictures, scans, corners;  ///< counts by sensor
  std::map<std::string, std::string> gates;  ///< by sensor: why it is not in the view; empty: it is
  std::map<std::string, Pick> picks;
};
std::string details_text(const ViewDetails& details);

}  // namespace ca2
