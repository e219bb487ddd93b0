/// @file GigE Vision and USB3 Vision cameras (Allied Vision, FLIR, Basler, ...) through Aravis.
#include <poll.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <thread>

#include "core/types/text.h"
#include "drivers/camera/aravis/aravis_device.h"
#include "drivers/camera/aravis/aravis_settings.h"
#include "drivers/camera/aravis/aravis_stream.h"
#include "drivers/camera/aravis/camera_clock.h"
#include "drivers/camera/aravis/camera_controls.h"
#include "drivers/camera/control_thread.h"
#include "drivers/camera/frame_count.h"
#include "drivers/camera/frame_watch.h"
#include "drivers/net/stop_event.h"
#include "drivers/shared_pool.h"

namespace ca2 {
namespace {

using Clock = std::chrono::steady_clock;

/// From the start of a stream to its first picture, beyond the frame period.
constexpr auto first_picture_patience = std::chrono::seconds(2);

Clock::duration seconds(double value) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(value));
}

/// What the control thread and the capture thread both know. Outlives the source where the camera does not
/// answer.
struct CameraState {
  GObjectPtr<ArvDevice> device;
  std::mutex features_mutex;  ///< Aravis evaluates a camera's description without locks
  mutable std::mutex mutex;   ///< of `controls`
  std::map<std::string, CameraControl> controls;
  std::atomic<double> exposure_us{0}, rate{0};
  std::atomic<bool> synchronized{false};  ///< PTP
  ControlThread thread;                   ///< last: its jobs use the others

  /// Reads the controls back. With `features_mutex` held.
  void refresh(const Features& features) {
    auto now = read_controls(features);
    if (const auto exposure = now.find("exposure_us"); exposure != now.end()) {
      exposure_us = features.number(features.name(Feature::exposure)).value_or(0);
    }
    rate = expected_rate(features);
    const char* status = features.name(Feature::ptp_status);
    // "Slave" of the standard, "Synced" of Allied Vision.
    const std::string ptp = status ? features.text(status).value_or("") : "";
    synchronized = ptp == "Slave" || ptp == "Synced";
    const std::lock_guard lock(mutex);
    for (auto& [name, control] : now) control.problem = controls[name].problem;
    controls = std::move(now);
  }
};

class AravisCamera : public CameraSource {
 public:
  AravisCamera(AravisSettings settings, std::shared_ptr<CameraState> state, std::string description,
               CameraStream stream)
      : settings_(std::move(settings)),
        state_(std::move(state)),
        description_(std::move(description)),
        streams_{std::move(stream)} {}

  ~AravisCamera() override {
    if (lost_.empty()) {
      stop();
    } else {
      bury();
    }
  }

  const std::vector<CameraStream>& streams() const override { return streams_; }
  std::string description() const override { return description_; }
  double frame_rate() const override { return state_->rate; }

  Result<void> start() override {
    const std::lock_guard lock(state_->features_mutex);
    StreamOptions options;
    options.packet_size = settings_.packet_size;
    options.buffers = settings_.buffers;
    options.resend = settings_.resend;
    auto stream = AravisStream::open(state_->device.get(), options);
    if (!stream) return fail(stream.error());
    const Features features(state_->device.get());
    if (auto started = features.execute("AcquisitionStart"); !started) return started;
    {
      const std::lock_guard counters(stream_mutex_);
      stream_ = std::move(*stream);
    }
    state_->refresh(features);
    watched_rate_ = -1;
    count_ = {};
    damaged_ = 0;
    underruns_ = 0;
    return {};
  }

  void stop() override {
    if (!stream_ || !lost_.empty()) return;
    {
      const std::lock_guard lock(state_->features_mutex);
      // A camera that does not answer any more is found out by next().
      static_cast<void>(Features(state_->device.get()).execute("AcquisitionStop"));
    }
    const std::lock_guard counters(stream_mutex_);
    resent_before_ += stream_->statistics().resent;
    stream_.reset();
  }

  void interrupt() noexcept override { stopped_.set(); }

  CameraPoll next(std::chrono::milliseconds timeout) override {
    watch_.look(Clock::now());
    CameraPoll poll = await(Clock::now() + timeout);
    watch_.leave(Clock::now());
    return poll;
  }

  Result<void> set_control(const std::string& name, const std::string& value) override {
    if (auto good = check_control(controls(), name, value); !good) return good;
    post([name, value](CameraState& state, const Features& features) {
      const auto written = write_control(features, name, value);
      state.refresh(features);
      const std::lock_guard lock(state.mutex);
      state.controls[name].problem = written ? "" : written.error().text();
    });
    return {};
  }

  std::map<std::string, CameraControl> controls() const override {
    const std::lock_guard lock(state_->mutex);
    return state_->controls;
  }

  Result<void> trigger() override {
    const auto now = controls();
    const auto mode = now.find("trigger");
    if (mode == now.end() || mode->second.value != "software") {
      return fail(ErrorCode::usage, description_, "is not waiting for triggers",
                  "set 'trigger' to 'software'");
    }
    post([](CameraState& state, const Features& features) {
      const auto fired = features.execute(features.name(Feature::trigger_software));
      const std::lock_guard lock(state.mutex);
      state.controls["trigger"].problem = fired ? "" : fired.error().text();
    });
    return {};
  }

  CameraCounters counters() const override {
    CameraCounters counters;
    counters.frames = frames_;
    counters.incomplete = incomplete_;
    counters.missed = missed_;
    counters.overrun = overrun_;
    const std::lock_guard lock(stream_mutex_);
    counters.resent = resent_before_ + (stream_ ? stream_->statistics().resent : 0);
    return counters;
  }

  std::vector<std::string> warnings() const override {
    const std::lock_guard lock(stream_mutex_);
    return stream_ ? stream_->warnings() : std::vector<std::string>();
  }

 private:
  CameraPoll await(Clock::time_point deadline) {
    for (;;) {
      if (stopped_.is_set()) return {CameraEvent::stopped, {}, {}};
      if (!lost_.empty()) return {CameraEvent::lost, {}, lost_};
      watch_rate();
      while (const auto buffer = stream_->pop()) {
        watch_.sign_of_life(Clock::now());
        auto frame = frame_of(buffer.get());
        if (frame) return {CameraEvent::frame, std::move(*frame), {}};
      }
      watch_.heard(stream_->last_leader());
      const auto now = Clock::now();
      if (stream_->control_lost()) {
        lost_ = "the camera gave up on us (its heartbeat went unanswered), or another program took it";
      } else if (const auto over = watch_.deadline(); over && now >= *over) {
        const auto silence = watch_.silence(now);
        lost_ = silence ? formatted("no picture for %.3f s, one was due every %.3f s",
                                    std::chrono::duration<double>(*silence).count(), 1 / watched_rate_)
                        : "no picture came since the start";
      } else if (now >= deadline) {
        return {};
      } else {
        wait(std::min(deadline, over.value_or(deadline)));
      }
    }
  }

  /// On the control thread, one after the other.
  void post(std::function<void(CameraState&, const Features&)> job) {
    state_->thread.post([state = state_.get(), job = std::move(job)] {
      const std::lock_guard lock(state->features_mutex);
      job(*state, Features(state->device.get()));
    });
  }

  /// The rate may have been changed by a control.
  void watch_rate() {
    const double rate = state_->rate;
    if (rate == watched_rate_) return;
    watched_rate_ = rate;
    // FrameWatch waits for three periods.
    const double period =
        rate > 0 ? std::max({1 / rate, 1e-6 * state_->exposure_us, settings_.silence / 3}) : 0;
    watch_.begin(Clock::now(), seconds(period), first_picture_patience);
  }

  void wait(Clock::time_point until) {
    pollfd polled[] = {{stream_->ready_fd(), POLLIN, 0}, {stopped_.fd(), POLLIN, 0}};
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now());
    const int ready = ::poll(polled, 2, static_cast<int>(std::clamp<std::int64_t>(left.count(), 0, 60'000)));
    if (ready == 0)
      watch_.overslept(std::max(Clock::duration(0), Clock::now() - until - std::chrono::milliseconds(1)));
  }

  std::optional<CameraFrame> frame_of(ArvBuffer* buffer) {
    const std::uint64_t id = arv_buffer_get_frame_id(buffer);
    RawPicture raw;
    std::size_t size = 0;
    Result<Image> image = fail(ErrorCode::data, "", "incomplete");
    if (arv_buffer_get_status(buffer) == ARV_BUFFER_STATUS_SUCCESS) {
      count_missing_before(id);
      raw.format = pixel_format_of_pfnc(arv_buffer_get_image_pixel_format(buffer));
      raw.width = arv_buffer_get_image_width(buffer);
      raw.height = arv_buffer_get_image_height(buffer);
      const void* data = arv_buffer_get_image_data(buffer, &size);
      raw.data = {static_cast<const std::uint8_t*>(data), size};
      raw.memory = &memory_;
      if (raw.format) image = to_image(raw, settings_.kind);
    } else {
      ++damaged_;
    }
    if (!image) {
      ++incomplete_;
      return std::nullopt;
    }
    ++frames_;
    CameraFrame frame;
    frame.image = pool_.keep(*image);
    memory_ = std::move(image->bytes);
    // Below 2^62, so that adding an exposure cannot overflow whatever a camera says.
    constexpr std::uint64_t sane = (std::uint64_t{1} << 62) - 1;
    const auto middle =
        clock_.middle({static_cast<std::int64_t>(arv_buffer_get_timestamp(buffer) & sane),
                       static_cast<std::int64_t>(arv_buffer_get_system_timestamp(buffer) & sane),
                       std::llround(1e3 * state_->exposure_us), state_->synchronized});
    frame.time = middle.time;
    frame.time_sigma = middle.sigma;
    frame.sequence = id;
    return frame;
  }

  /// Before a whole picture. Only these are asked for their number: one whose first packet did not come has
  /// that of the picture that was in its buffer before.
  void count_missing_before(std::uint64_t id) {
    const std::uint64_t gap = count_.missing_before(id);
    // Those that came damaged are in the gap, and counted.
    const std::uint64_t missing = gap - std::min(gap, std::exchange(damaged_, 0));
    if (missing == 0) return;
    // Aravis counts every packet that finds no buffer: it only says that there were some.
    const std::uint64_t underruns = stream_->statistics().underruns;
    (std::exchange(underruns_, underruns) == underruns ? missed_ : overrun_) += missing;
  }

  /// A camera that does not answer keeps who closes it waiting for 10 s (stop, control and heartbeat time out
  /// one after the other). Nobody needs the outcome, so that a thread of its own waits; it ends with the
  /// process.
  void bury() {
    std::shared_ptr<AravisStream> stream = std::move(stream_);
    std::thread([stream = std::move(stream), state = std::move(state_)]() mutable {
      {
        const std::lock_guard lock(state->features_mutex);
        static_cast<void>(Features(state->device.get()).execute("AcquisitionStop"));
      }
      stream.reset();
      state.reset();
    }).detach();
  }

  const AravisSettings settings_;
  std::shared_ptr<CameraState> state_;
  const std::string description_;
  const std::vector<CameraStream> streams_;
  StopEvent stopped_;
  // Of the capture thread:
  FrameWatch watch_;
  SharedPool<Image> pool_;
  std::vector<std::uint8_t> memory_;  ///< of the next picture
  double watched_rate_ = -1;
  FrameCount count_;             ///< of whole pictures
  std::uint64_t damaged_ = 0;    ///< pictures since the last whole one
  std::uint64_t underruns_ = 0;  ///< Aravis's count at the last gap
  CameraClock clock_;
  std::string lost_;  ///< why; empty: it is there
  std::atomic<std::uint64_t> frames_{0}, incomplete_{0}, missed_{0}, overrun_{0};
  mutable std::mutex stream_mutex_;  ///< of the two below, while they change
  std::unique_ptr<AravisStream> stream_;
  std::uint64_t resent_before_ = 0;  ///< packets, in streams that are over
};

Result<std::unique_ptr<CameraSource>> open(OptionReader& options) {
  auto settings = read_aravis_settings(options);
  if (!settings) return fail(settings.error());
  auto device = open_aravis_device(settings->id);
  if (!device) return fail(device.error());
  auto state = std::make_shared<CameraState>();
  state->device = std::move(*device);
  const Features features(state->device.get());
  if (auto applied = apply_settings(*settings, state->device.get(), features); !applied)
    return fail(applied.error());
  const std::string name = describe_aravis_device(state->device.get());
  // What a camera answers may be any number.
  const auto bounded = [&](const char* feature, double most) {
    return std::min(std::max(0.0, features.number(feature).value_or(0)), most);
  };
  const auto code = static_cast<std::uint32_t>(bounded("PixelFormat", 4294967295.0));
  const PixelFormat* format = pixel_format_of_pfnc(code);
  if (!format) {
    return fail(ErrorCode::config, name,
                formatted("sends pixel format 0x%08x, which is not known here", code),
                "choose another with 'format'");
  }
  CameraStream stream;
  stream.width = static_cast<int>(bounded("Width", 1e6));
  stream.height = static_cast<int>(bounded("Height", 1e6));
  stream.format = format->name;
  const auto odd = [&](const char* offset) {
    return features.has(offset) && std::fmod(features.number(offset).value_or(0), 2) != 0;
  };
  if (format->bayer() && (odd("OffsetX") || odd("OffsetY"))) {
    return fail(ErrorCode::config, name, "odd offsets shift the Bayer mosaic", "choose even ones");
  }
  state->refresh(features);
  return std::make_unique<AravisCamera>(std::move(*settings), std::move(state), name, std::move(stream));
}

Result<std::vector<FoundCamera>> list() {
  return find_aravis_cameras();
}

}  // namespace

const CameraDriver& aravis_camera_driver() {
  static const CameraDriver driver{"aravis", "GigE Vision and USB3 Vision cameras", aravis_options(), open,
                                   list};
  return driver;
}

}  // namespace ca2
