#include "core/capture/sensor_status.h"

#include <algorithm>
#include <cmath>

namespace ca2 {

SensorStatus camera_status(const Tracks& tracks, std::size_t camera_index, const CaptureOptions& options,
                           std::int64_t time) {
  const CameraTrack& camera = tracks.cameras[camera_index];
  SensorStatus status;
  status.name = tracks.camera_names[camera_index];
  status.is_camera = true;
  status.silent = camera.rhythm().silent(time);
  status.rate = status.silent ? 0 : camera.rhythm().rate();
  status.frames = camera.frames();
  status.shed = camera.shed();
  status.let_go = camera.let_go();
  status.sees_board = !status.silent && camera.newest() && !camera.newest()->corners.empty();
  const auto still = camera.stillness(time, options.board_motion, options.dwell);
  status.motion = still ? still->motion : std::nan("");
  status.motion_limit = still ? still->limit : std::nan("");
  return status;
}

SensorStatus lidar_status(const Tracks& tracks, std::size_t lidar_index, const CaptureOptions& options,
                          std::int64_t time) {
  const LidarTrack& lidar = tracks.lidars[lidar_index];
  SensorStatus status;
  status.name = tracks.lidar_names[lidar_index];
  status.silent = lidar.rhythm().silent(time);
  status.rate = status.silent ? 0 : lidar.rhythm().rate();
  status.frames = lidar.frames();
  status.shed = lidar.shed();
  status.let_go = lidar.let_go();
  status.motion = std::nan("");
  status.motion_limit = options.lidar_motion;
  if (status.silent || !lidar.newest()) return status;
  // What is new to the room and moves least, over the dwell.
  const auto window = static_cast<std::int64_t>(1e9 * options.dwell) + lidar.period();
  for (const LidarHold& held :
       LidarTrack::follow(lidar.within(lidar.newest()->time - window, lidar.newest()->time + window))) {
    if (!(held.novelty > 0.5)) continue;
    status.sees_board = true;
    status.motion = std::isnan(status.motion) ? held.motion : std::min(status.motion, held.motion);
  }
  return status;
}

}  // namespace ca2
