#include "drivers/recording/recording_reader.h"

#include <algorithm>
#include <deque>

#include "drivers/camera/camera_driver.h"
#include "drivers/lidar/capture_doubts.h"
#include "drivers/lidar/lidar_driver.h"
#include "drivers/lidar/scan_clock.h"
#include "drivers/net/pcap_reader.h"

namespace ca2 {
namespace {

/// One sensor's data in order, one frame ahead.
class Stream {
 public:
  Stream() = default;
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;
  virtual ~Stream() = default;
  /// The next frame, without `sensor`; nothing at the end, and from then on.
  virtual std::optional<RecordedFrame> read() = 0;

  std::optional<RecordedFrame> head;
};

class Pictures : public Stream {
 public:
  Pictures(std::unique_ptr<CameraSource> source, int total) : source_(std::move(source)), total_(total) {}

  static Result<std::unique_ptr<Pictures>> open(const std::filesystem::path& folder) {
    auto source = open_camera({{"driver", "image_folder"}, {"path", folder.string()}, {"speed", "0"}});
    if (!source) return fail(source.error());
    if (const auto started = (*source)->start(); !started) return fail(started.error());
    int total = 0;
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
      total += entry.path().extension() == ".png" || entry.path().extension() == ".jpg";
    }
    return std::make_unique<Pictures>(std::move(*source), total);
  }

  std::optional<RecordedFrame> read() override {
    CameraPoll poll = source_->next(std::chrono::milliseconds(0));
    if (poll.event != CameraEvent::frame) return std::nullopt;
    RecordedFrame frame;
    frame.time = frame.arrival = poll.frame.time;
    frame.image = std::move(poll.frame.image);
    return frame;
  }

  int total() const { return total_; }
  int damaged() const { return static_cast<int>(source_->counters().incomplete); }

 private:
  std::unique_ptr<CameraSource> source_;
  int total_;
};

class Packets : public Stream {
 public:
  Packets(std::string file, std::unique_ptr<PcapReader> reader, LidarDriver driver)
      : file_(std::move(file)), reader_(std::move(reader)), driver_(std::move(driver)) {}

  static Result<std::unique_ptr<Packets>> open(const std::filesystem::path& file,
                                               const LidarModelSpec& spec) {
    LidarDriverOptions options;
    options.one_source = true;
    options.streamed_calibration = spec.metadata.empty() && spec.calibration.empty();
    auto driver = LidarDriver::open(spec, options);
    if (!driver) return fail(driver.error());
    auto reader = PcapReader::open(file);
    if (!reader) return fail(reader.error());
    return std::make_unique<Packets>(file.string(), std::move(*reader), std::move(*driver));
  }

  std::optional<RecordedFrame> read() override {
    const LidarSink sink = [&](LidarScan&& scan) {
      // A torn first or last revolution shows a part of the room only.
      if (!scan.complete && scan.scan.empty()) return;
      const std::int64_t arrival = scan.clock.empty() ? 0 : scan.clock.back().host;
      std::optional<TimedScan> timed = clock_.map(std::move(scan));
      if (timed) ready_.push_back({0, timed->time, arrival, nullptr, std::move(timed->scan)});
    };
    while (ready_.empty() && !ended_) {
      const Result<PacketBatch> batch = reader_->next_batch();
      if (!batch) warnings = batch.error().problems;
      ended_ = !batch || batch->event == PacketEvent::end;
      if (!ended_) {
        for (const Datagram& datagram : batch->datagrams) driver_.push(datagram, sink);
      } else {
        driver_.flush(sink);
        const std::vector<Problem> doubts = capture_doubts(file_, driver_, reader_->counters());
        warnings.insert(warnings.end(), doubts.begin(), doubts.end());
      }
    }
    if (ready_.empty()) return std::nullopt;
    RecordedFrame frame = std::move(ready_.front());
    ready_.pop_front();
    return frame;
  }

  std::vector<Problem> warnings;  ///< not yet told

 private:
  std::string file_;
  std::unique_ptr<PcapReader> reader_;
  LidarDriver driver_;
  ScanClock clock_;
  std::deque<RecordedFrame> ready_;
  bool ended_ = false;
};

}  // namespace

struct RecordingReader::State {
  struct Camera {
    int index;
    std::string name;
    std::unique_ptr<Pictures> stream;
    int damaged = 0;
  };
  struct Lidar {
    int index;
    std::string name;
    std::unique_ptr<Packets> stream;
  };
  std::vector<Camera> cameras;
  std::vector<Lidar> lidars;
  std::vector<Problem> warnings;
  int total = 0, given = 0;

  void warn(const Error& error) {
    warnings.insert(warnings.end(), error.problems.begin(), error.problems.end());
  }

  void fill(Camera& camera) {
    camera.stream->head = camera.stream->read();
    if (camera.stream->damaged() > camera.damaged) {
      camera.damaged = camera.stream->damaged();
      warnings.push_back({camera.name, "a picture cannot be read or has another size: it is left out", {}});
    }
  }
  void fill(Lidar& lidar) {
    lidar.stream->head = lidar.stream->read();
    std::vector<Problem>& told = lidar.stream->warnings;
    warnings.insert(warnings.end(), told.begin(), told.end());
    told.clear();
  }
};

RecordingReader::RecordingReader(std::unique_ptr<State> state) : state_(std::move(state)) {}
RecordingReader::RecordingReader(RecordingReader&&) noexcept = default;
RecordingReader& RecordingReader::operator=(RecordingReader&&) noexcept = default;
RecordingReader::~RecordingReader() = default;

Result<RecordingReader> RecordingReader::open(const Recording& recording) {
  auto state = std::make_unique<State>();
  int index = 0;
  for (const auto& [name, camera] : recording.rig.cameras) {
    const int at = index++;
    auto stream = Pictures::open(recording.pictures(name));
    if (!stream) {
      state->warn(stream.error());
      continue;
    }
    state->total += (*stream)->total();
    state->cameras.push_back({at, name, std::move(*stream)});
    state->fill(state->cameras.back());
  }
  index = 0;
  for (const auto& [name, lidar] : recording.rig.lidars) {
    const int at = index++;
    auto stream = Packets::open(recording.packets(name), recording.model(name));
    if (!stream) {
      state->warn(stream.error());
      continue;
    }
    state->lidars.push_back({at, name, std::move(*stream)});
    state->fill(state->lidars.back());
  }
  const bool any = std::any_of(state->cameras.begin(), state->cameras.end(),
                               [](const auto& camera) { return camera.stream->head.has_value(); }) ||
                   std::any_of(state->lidars.begin(), state->lidars.end(),
                               [](const auto& lidar) { return lidar.stream->head.has_value(); });
  if (!any) {
    state->warnings.push_back({recording.directory.string(), "no sensor of the rig has data in it", {}});
    return fail(ErrorCode::data, std::move(state->warnings));
  }
  return RecordingReader(std::move(state));
}

std::optional<RecordedFrame> RecordingReader::next() {
  State::Camera* camera = nullptr;
  State::Lidar* lidar = nullptr;
  for (State::Camera& one : state_->cameras) {
    if (!one.stream->head) continue;
    if (!camera || one.stream->head->arrival < camera->stream->head->arrival) camera = &one;
  }
  for (State::Lidar& one : state_->lidars) {
    if (!one.stream->head) continue;
    if (!lidar || one.stream->head->arrival < lidar->stream->head->arrival) lidar = &one;
  }
  if (!camera && !lidar) return std::nullopt;
  const bool picture = camera && (!lidar || camera->stream->head->arrival <= lidar->stream->head->arrival);
  RecordedFrame frame = picture ? *std::move(camera->stream->head) : *std::move(lidar->stream->head);
  frame.sensor = picture ? camera->index : lidar->index;
  if (picture)
    state_->fill(*camera);
  else
    state_->fill(*lidar);
  state_->given += picture ? 1 : 0;
  return frame;
}

const std::vector<Problem>& RecordingReader::warnings() const {
  return state_->warnings;
}
int RecordingReader::pictures() const {
  return state_->total;
}
int RecordingReader::pictures_read() const {
  return state_->given;
}

}  // namespace ca2
