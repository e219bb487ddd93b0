/// @file What a calibration looks like to other software: one function per format, listed in exporters.def.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/export/frame_graph.h"
#include "core/session/calibration.h"
#include "core/types/result.h"

namespace ca2 {

/// Something the calibration rests on: a sensor's serial number, a file's hash.
struct ProvenanceEntry {
  std::string subject;  ///< "lidars.top.serial", "views/000001/left.png"
  std::string value;
};

struct ExportRequest {
  Calibration calibration;
  FrameGraph frames;                  ///< every frame that can be named
  std::string parent;                 ///< sensor or frame; empty: the format's default
  std::vector<std::string> children;  ///< sensors or frames; empty: the format's default
  std::string session;                ///< name, for people
  std::vector<ProvenanceEntry> provenance;
};

struct ExportFile {
  std::string name;  ///< relative, without directories
  std::string content;
  bool main = true;  ///< what is printed where no output is named; the others are the same in other clothes
};
using ExportFiles = std::vector<ExportFile>;

struct Exporter {
  std::string_view name;
  std::string_view help;
  /// ErrorCode::usage for a frame that is not known, ErrorCode::refused for what the format cannot express:
  /// nothing is rounded, truncated or left out in silence.
  Result<ExportFiles> (*write)(const ExportRequest&);
};

/// The formats of exporters.def, in its order.
std::span<const Exporter> exporters();
/// nullptr when there is none of that name.
const Exporter* find_exporter(std::string_view name);

}  // namespace ca2
