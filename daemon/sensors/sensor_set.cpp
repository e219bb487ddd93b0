#include "daemon/sensors/sensor_set.h"

#include "daemon/config/check_sources.h"
#include "daemon/sensors/camera_sensor.h"
#include "daemon/sensors/lidar_sensor.h"
#include "daemon/sensors/recording_sensor.h"

namespace ca2 {

SensorSet::SensorSet(const Config& config, const std::optional<Recording>& recording, Recorder& recorder,
                     ObservationSink observations, std::function<void(SensorHealths)> healths,
                     Heartbeats& heartbeats)
    : recorder_(recorder), detectors_(config.rig, std::move(observations), heartbeats) {
  std::vector<std::unique_ptr<SensorDevice>> devices;
  if (recording) {
    devices.push_back(make_recording_sensor(*recording, *this));
  } else {
    // The configuration was judged when it was read: there are devices.
    std::vector<CameraDevice> cameras = camera_devices(config.rig.cameras).value();
    for (CameraDevice& device : cameras) {
      if (const auto path = device.source.find("path"); path != device.source.end()) {
        path->second = resolve(path->second, config.file).string();
      }
      devices.push_back(make_camera_sensor(config.rig, device, *this));
    }
    for (auto& device : make_lidar_sensors(config.rig, config.file, config.options.state_directory, *this)) {
      devices.push_back(std::move(device));
    }
  }
  for (auto& device : devices) {
    supervisors_.push_back(std::make_unique<Supervisor>(std::move(device), healths, heartbeats));
  }
}

SensorSet::~SensorSet() {
  stop();
}

void SensorSet::stop() noexcept {
  for (const auto& supervisor : supervisors_) supervisor->stop();
}

void SensorSet::picture(int camera, const std::string& name, std::int64_t time,
                        std::shared_ptr<const Image> image) {
  recorder_.picture(name, time, image);
  detectors_.add(camera, time, std::move(image));
}

void SensorSet::scan(int lidar, std::int64_t time, std::shared_ptr<const Scan> scan) {
  detectors_.add(lidar, time, std::move(scan));
}

void SensorSet::datagram(const std::string& lidar, const Datagram& datagram) {
  recorder_.datagram(lidar, datagram);
}

}  // namespace ca2
