/// @file Where the beams of spinning LiDARs begin.
#pragma once

#include <span>
#include <string_view>

namespace ca2 {

/// A spinning LiDAR with one lens sends its beams from there, not from the axis it turns about: a beam of
/// elevation e then meets the axis radius * tan(e) below the frame's origin. By the table of "vertical
/// correction" in the VLP-16's manual (63-9243): 11.2 mm at 15 degrees. Drivers and the files
/// made with them leave it out more often than not, and then points high or low are that much off.
///
/// The lens's distance from the axis, m, of a model as a rig names it ("VLP-16" and "vlp16" are one name); 0
/// where nothing is known.
double beam_lens_radius(std::string_view model);

/// The same of a LiDAR without a name, by the elevations of its beams (rad): those under which the frame's
/// origin sees its returns. What has the VLP-16's 16 beams may still be another LiDAR's.
double beam_lens_radius(std::span<const float> elevations);

}  // namespace ca2
