/// @file Where the beams of spinning LiDARs begin.
#pragma once

#include <string_view>

namespace ca2 {

/// A spinning LiDAR with one lens sends its beams from there, not from the axis it turns about: a beam of
/// elevation e then meets the axis radius * tan(e) below the frame's origin. By the table of "vertical
/// correction" in the VLP-16's manual (63-9243): 11.2 mm at 15 degrees. Drivers and the files
/// made with them leave it out more often than not, and then points high or low are that much off.
///
/// The lens's distance from the axis, m, of a model as a rig names it; 0 where nothing is known.
double beam_lens_radius(std::string_view model);

}  // namespace ca2
