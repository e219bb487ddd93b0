#include "daemon/sensors/camera_sensor.h"

#include <algorithm>
#include <chrono>
#include <mutex>

#include "core/types/text.h"

namespace ca2 {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds poll_time{200};
// Frame-age watchdog: so many periods without a picture, and at least so long, and the device is opened
// again.
constexpr double missing_periods = 5;
constexpr std::chrono::duration<double> shortest_patience{1.0};

struct Imager {
  int camera = 0;  ///< index in the rig's order
  std::string name;
  int width = 0, height = 0;      ///< px, as the rig says; 0: any
  int stream = 0;                 ///< of the device, while it is open
  std::uint64_t lost_before = 0;  ///< pictures, by devices that were closed
};

class CameraSensor : public SensorDevice {
 public:
  CameraSensor(const Rig& rig, CameraDevice device, InputSink& sink)
      : device_(std::move(device)), sink_(sink) {
    for (const auto& [imager, name] : device_.cameras) {
      const auto entry = rig.cameras.find(name);
      const int index = static_cast<int>(std::distance(rig.cameras.begin(), entry));
      Imager& mine = imagers_[imager];
      mine.camera = index;
      mine.name = name;
      mine.width = entry->second.width;
      mine.height = entry->second.height;
    }
  }

  Result<void> open() override {
    auto source = open_camera(device_.source);
    if (!source) return fail(source.error());
    by_stream_.assign((*source)->streams().size(), nullptr);
    for (auto& [imager, rig_camera] : imagers_) {
      const Result<int> stream = find_stream(**source, imager);
      if (!stream) return fail(stream.error());
      const CameraStream& found = (*source)->streams()[static_cast<std::size_t>(*stream)];
      if (rig_camera.width > 0 && (found.width != rig_camera.width || found.height != rig_camera.height)) {
        return fail(ErrorCode::config, rig_camera.name,
                    formatted("the camera gives %d x %d, the rig says %d x %d", found.width, found.height,
                              rig_camera.width, rig_camera.height),
                    "intrinsics hold for one size only");
      }
      rig_camera.stream = *stream;
      by_stream_[static_cast<std::size_t>(*stream)] = &rig_camera;
    }
    if (const auto started = (*source)->start(); !started) return started;
    description_ = (*source)->description();
    last_picture_ = Clock::now();
    const std::lock_guard lock(mutex_);
    source_ = std::move(*source);
    if (interrupted_) source_->interrupt();
    return {};
  }

  Step step() override {
    CameraPoll poll = source_->next(poll_time);
    if (poll.event == CameraEvent::lost) return {Event::lost, poll.reason};
    if (poll.event == CameraEvent::end) return {Event::ended, {}};
    if (poll.event == CameraEvent::frame) {
      last_picture_ = Clock::now();
      if (const Imager* imager = by_stream_.at(static_cast<std::size_t>(poll.frame.stream))) {
        clock_sigma_ = 1e-9 * static_cast<double>(poll.frame.time_sigma);
        sink_.picture(imager->camera, imager->name, poll.frame.time, std::move(poll.frame.image));
      }
      return {};
    }
    return judge_age();
  }

  void close() override {
    std::unique_ptr<CameraSource> source;
    {
      const std::lock_guard lock(mutex_);
      source = std::move(source_);
    }
    for (auto& [name, imager] : imagers_) imager.lost_before += source->counters_of(imager.stream).lost();
    source->stop();
    description_.clear();
  }

  void interrupt() noexcept override {
    const std::lock_guard lock(mutex_);
    interrupted_ = true;
    if (source_) source_->interrupt();
  }

  std::map<std::string, SensorHealth> health() const override {
    std::map<std::string, SensorHealth> all;
    for (const auto& [name, imager] : imagers_) {
      SensorHealth& health = all[imager.name];
      health.device = description_;
      health.lost = imager.lost_before + (source_ ? source_->counters_of(imager.stream).lost() : 0);
      health.clock_sigma = clock_sigma_;
    }
    return all;
  }

 private:
  Step judge_age() const {
    const double rate = source_->frame_rate();
    if (rate <= 0) return {};  // pictures come when they come
    const std::chrono::duration<double> age = Clock::now() - last_picture_;
    const auto patience = std::max(shortest_patience, std::chrono::duration<double>(missing_periods / rate));
    if (age <= patience) return {};
    return {Event::lost, formatted("no picture for %.1f s", age.count())};
  }

  CameraDevice device_;
  InputSink& sink_;
  std::map<std::string, Imager> imagers_;
  std::vector<const Imager*> by_stream_;
  std::string description_;
  Clock::time_point last_picture_;
  double clock_sigma_ = std::numeric_limits<double>::quiet_NaN();

  std::mutex mutex_;  ///< source_ as interrupt() sees it
  std::unique_ptr<CameraSource> source_;
  bool interrupted_ = false;
};

}  // namespace

std::unique_ptr<SensorDevice> make_camera_sensor(const Rig& rig, const CameraDevice& device,
                                                 InputSink& sink) {
  return std::make_unique<CameraSensor>(rig, device, sink);
}

}  // namespace ca2
