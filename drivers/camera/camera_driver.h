/// @file The kinds of cameras, and how a rig's `source:` opens one. One file per kind in sources/, one line
/// in sources.def (docs/adding-a-camera.md).
#pragma once

#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/session/rig.h"
#include "drivers/camera/camera_source.h"
#include "drivers/camera/option_reader.h"

namespace ca2 {

/// A key of a `source:` mapping.
struct CameraOption {
  std::string_view name;
  std::string_view what;    ///< meaning, unit, limits and default, for people
  bool identifies = false;  ///< says which device is meant: equal ones mean the same device
};

/// A camera that is there to be opened.
struct FoundCamera {
  std::string driver;
  std::string id;           ///< stable: a serial number or a place on a bus
  std::string description;  ///< vendor, model, where it is connected
  SourceOptions source;     ///< what a rig writes to get it
  std::string problem;      ///< why it cannot be used now; empty when nothing is known against it
};

/// A kind of camera. Without state: one instance each, listed in sources.def.
struct CameraDriver {
  std::string_view name;
  std::string_view what;  ///< one line, for people
  std::span<const CameraOption> options;
  /// Opens the device. Unknown options are noted in the reader already; the driver reads all of its own
  /// before it acts, and stops at `options.done()`.
  Result<std::unique_ptr<CameraSource>> (*open)(OptionReader& options);
  /// What is connected; empty for kinds that cannot be discovered.
  Result<std::vector<FoundCamera>> (*list)();
};

/// The drivers of sources.def, in its order.
std::span<const CameraDriver* const> camera_drivers();

/// Opens what a `source:` mapping names (`driver` and that driver's options). ErrorCode::config where the
/// mapping is wrong (every problem, with the options known), `unavailable` where the device is not there.
/// Paths are as the working directory sees them. `imager` is not looked at: a device is opened with all of
/// its imagers.
Result<std::unique_ptr<CameraSource>> open_camera(const SourceOptions& source);

struct CameraListing {
  std::vector<FoundCamera> cameras;  ///< by driver, then id
  std::vector<Problem> problems;     ///< drivers that could not look
};
CameraListing list_cameras();

/// A device that serves one or several of a rig's cameras.
struct CameraDevice {
  SourceOptions source;  ///< for open_camera
  std::map<std::string, std::string>
      cameras;  ///< the rig's camera by imager (CameraStream::name, "" for one)
};

/// The devices of a rig's cameras, so that each is opened once: sources with the same driver and the same
/// identifying options are one device, told apart by `imager`. Options that only one of them gives count for
/// the device. ErrorCode::config with every problem: no source, unknown driver, one imager for two cameras,
/// options that disagree.
Result<std::vector<CameraDevice>> camera_devices(const std::map<std::string, RigCamera>& cameras);

/// Which of the open device's streams an imager is; ErrorCode::config with those there are.
Result<int> find_stream(const CameraSource& source, std::string_view imager);

}  // namespace ca2
