#include "daemon/sensors/recording_sensor.h"

#include <chrono>
#include <optional>

#include "daemon/log.h"
#include "drivers/net/pacer.h"
#include "drivers/net/stop_event.h"
#include "drivers/recording/recording_reader.h"

namespace ca2 {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds longest_wait{200};

class RecordingSensor : public SensorDevice {
 public:
  RecordingSensor(const Recording& recording, InputSink& sink) : recording_(recording), sink_(sink) {
    for (const auto& [name, camera] : recording.rig.cameras) cameras_.push_back(name);
  }

  Result<void> open() override {
    auto reader = RecordingReader::open(recording_);
    if (!reader) return fail(reader.error());
    reader_.emplace(std::move(*reader));
    for (const Problem& problem : reader_->warnings()) {
      log::warning("sensor", Error(ErrorCode::data, problem.where, problem.what, problem.hint).text());
    }
    pacer_.wait(recording_.start, now());  // the first frame keeps its distance from the recording's start
    return {};
  }

  Step step() override {
    if (!frame_) frame_ = reader_->next();
    if (!frame_) return {Event::ended, {}};
    const std::chrono::nanoseconds wait(pacer_.wait(frame_->arrival, now()));
    if (wait.count() > 0) {
      const auto end = Clock::now() + std::min<std::chrono::nanoseconds>(wait, longest_wait);
      if (stop_.wait_until(end) || wait > longest_wait) return {};
    }
    if (frame_->image) {
      const std::string& name = cameras_.at(static_cast<std::size_t>(frame_->sensor));
      sink_.picture(frame_->sensor, name, frame_->time, std::move(frame_->image));
    } else {
      sink_.scan(frame_->sensor, frame_->time, std::move(frame_->scan));
    }
    frame_.reset();
    return {};
  }

  void close() override { reader_.reset(); }
  void interrupt() noexcept override { stop_.set(); }

  std::map<std::string, SensorHealth> health() const override {
    SensorHealth health;
    health.device = "recording " + recording_.directory.string();
    std::map<std::string, SensorHealth> all;
    for (const std::string& name : cameras_) all[name] = health;
    for (const auto& [name, lidar] : recording_.rig.lidars) all[name] = health;
    return all;
  }

 private:
  static std::int64_t now() { return std::chrono::nanoseconds(Clock::now().time_since_epoch()).count(); }

  Recording recording_;
  InputSink& sink_;
  std::vector<std::string> cameras_;
  std::optional<RecordingReader> reader_;
  std::optional<RecordedFrame> frame_;  ///< the next, not yet due
  Pacer pacer_{1};
  StopEvent stop_;
};

}  // namespace

std::unique_ptr<SensorDevice> make_recording_sensor(const Recording& recording, InputSink& sink) {
  return std::make_unique<RecordingSensor>(recording, sink);
}

}  // namespace ca2
