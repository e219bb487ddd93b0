/// @file What is simulated: the true rig, its noise, where the board is shown, and the room around it.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "core/board/board.h"
#include "core/camera/camera_model.h"
#include "core/geometry/pose.h"
#include "drivers/lidar/beam_table.h"

namespace ca2 {

struct CameraNoise {
  double sigma = 0.007;        ///< standard deviation of a pixel, of full scale
  double blur = 0.7;           ///< px, Gaussian, on top of the pixel's own square aperture
  double vignetting = 0.2;     ///< share of the light lost in the picture's corners
  int bits = 8;                ///< 8 or 16
  double corner_sigma = 0.05;  ///< px, of a corner's coordinate where no picture is rendered
};

struct LidarNoise {
  double range_sigma = 0.01;         ///< m, one return
  double range_bias = 0;             ///< m, measured minus true, of every return
  double reflectivity_bias = 0;      ///< m, further bias of a return from a black surface
  double divergence = 0.002;         ///< rad, full angle of the beam
  double beam_width = 0;             ///< m, of the beam where it leaves the LiDAR
  double pulse_length = 0.3;         ///< m: surfaces nearer to each other than this blend into one return
  double dropout = 0.005;            ///< share of returns that are lost
  double intensity_sigma = 0.05;     ///< relative
  int sweeps = 1;                    ///< revolutions gathered per view
  bool free_running_azimuth = true;  ///< firing is not locked to the encoder (Velodyne); false: Ouster
};

struct SimulatedCamera {
  Camera camera;  ///< the true one
  Pose T_rig_camera;
  CameraNoise noise;
};

struct SimulatedLidar {
  BeamTable beams;
  Pose T_rig_lidar;
  LidarNoise noise;
};

/// Where and how the board is shown; a place is drawn until every sensor of the group sees the board.
struct Placement {
  double min_distance = 1, max_distance = 3;  ///< m, from the first sensor of the group
  double min_tilt = 0.1, max_tilt = 0.8;      ///< rad, between the line of sight and the board's normal
  double max_roll = 0.5;                      ///< rad, about the board's normal
  double pixel_margin = 10;                   ///< px: corners stay this far inside the picture
  int min_rings = 3;                          ///< on the board, of every LiDAR
  int min_returns = 25;                       ///< on the board, of every LiDAR, in one revolution
  /// Sensors that must see the board, by name; views take the groups in turn. Empty: one group of all.
  std::vector<std::vector<std::string>> groups;
};

/// The room round the rig: the rig frame's z axis is vertical, its origin over the middle of the floor.
struct Room {
  double length = 10, width = 8, height = 3;  ///< m, along the rig's x, y and z
  double rig_height = 1.2;                    ///< m, of the rig frame's origin over the floor
  int furniture = 8;                          ///< tables, cabinets, boxes and panels along the walls
  bool person = true;                         ///< holds the board; otherwise it floats
  bool second_person = false;                 ///< stands somewhere
  double hand_cover = 0.02;                   ///< m of the plate's rim that the hands cover
};

/// How the board is carried from hold to hold in a recording.
struct Carrying {
  double min_hold = 0.8, max_hold = 1.6;  ///< s
  double min_move = 0.7, max_move = 1.5;  ///< s, from one place to the next
  double away = 0.2;                      ///< share of the holds before which the person walks out of view
  double tremor = 0.0003;    ///< m rms, of hands at 6 to 11 Hz; angles: the same at the board's rim
  double drift = 0.0006;     ///< m rms, of arms below 1 Hz
  double camera_rate = 15;   ///< pictures per second
  bool triggered = true;     ///< all cameras expose together; false: each at its own moment
  double lost_pictures = 0;  ///< share of them that never arrive
  double clock_offset = 0;   ///< s: the pictures' stamps are late by so much
};

/// What makes a view lie, so that consensus has something to do.
enum class WrongObject {
  none,
  panel,  ///< the scan sees, instead of the board, another plate of about its size at another place
  moved,  ///< the scan was taken with the board at another place than the picture
};

struct Scenario {
  std::string name;
  Board board;
  double bend = 0;  ///< m, see Plate
  std::map<std::string, SimulatedCamera> cameras;
  std::map<std::string, SimulatedLidar> lidars;
  Placement placement;
  Carrying carrying;
  std::optional<Room> room;  ///< absent: the board may be anywhere, and no pictures can be rendered
  WrongObject wrong_object = WrongObject::moved;
  double wrong_fraction = 0;  ///< of the views
  int views = 20;
  std::uint64_t seed = 1;

  /// Where a camera or LiDAR truly is.
  const Pose& T_rig_sensor(const std::string& sensor) const;
};

/// The generator of one view: views do not depend on each other, so that more of them extend a data set.
std::mt19937_64 view_generator(const Scenario& scenario, int view);

/// The sensors that must see the board in this view (numbered from 1).
std::vector<std::string> sensors_of_view(const Scenario& scenario, int view);

}  // namespace ca2
