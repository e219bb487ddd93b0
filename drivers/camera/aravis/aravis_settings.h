/// @file What a rig may say about a GenICam camera, and how it is told to the camera.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "drivers/camera/aravis/features.h"
#include "drivers/camera/camera_driver.h"
#include "drivers/camera/option_reader.h"
#include "drivers/camera/pixel_formats/pixel_format.h"

namespace ca2 {

struct AravisSettings {
  std::string id;        ///< empty: the only camera
  std::string user_set;  ///< loaded first; empty: the camera stays as it is
  std::string format;    ///< PFNC name; empty: 8 bits, mono before Bayer
  std::string features;  ///< "Name=value Name=value", set after all others
  std::optional<int> width, height, offset_x, offset_y, binning;
  std::map<std::string, std::string> controls;  ///< exposure_us, gain_db, frame_rate, trigger
  int packet_size = 0;                          ///< bytes; 0: the largest that arrives
  int buffers = 16;
  double silence = 0;  ///< s that the camera may be silent; 0: three frame periods
  bool resend = true;
  bool ptp = false;
  PictureKind kind = PictureKind::grey;
};

std::span<const CameraOption> aravis_options();
Result<AravisSettings> read_aravis_settings(OptionReader& options);

/// In the order that cameras want: set, size, format, then exposure, gain, rate or trigger, PTP. The camera
/// must not be streaming. All that it refuses is reported with the feature's name.
Result<void> apply_settings(const AravisSettings& settings, ArvDevice* device, const Features& features);

}  // namespace ca2
