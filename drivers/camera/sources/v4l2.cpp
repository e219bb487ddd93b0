/// @file Cameras of the kernel's own drivers: USB (UVC), laptop and CSI cameras, through V4L2.
#include <poll.h>

#include <atomic>
#include <cmath>
#include <mutex>

#include "core/types/text.h"
#include "drivers/camera/camera_driver.h"
#include "drivers/camera/control_thread.h"
#include "drivers/camera/frame_watch.h"
#include "drivers/camera/host_time.h"
#include "drivers/camera/v4l2/buffers.h"
#include "drivers/camera/v4l2/controls.h"
#include "drivers/camera/v4l2/device.h"
#include "drivers/camera/v4l2/negotiation.h"
#include "drivers/net/stop_event.h"
#include "drivers/shared_pool.h"

namespace ca2 {
namespace {

using Clock = std::chrono::steady_clock;

constexpr CameraOption options_known[] = {
    {"id",
     "name in /dev/v4l/by-id or by-path, or a path like /dev/video0, as `ca2 sensors` lists; default: the "
     "only one",
     true},
    {"format", "GREY, Y16, YUYV, MJPG, ...; default: uncompressed, grey before colours"},
    {"picture", "grey (default) or colour"},
    {"width", "px; default: the camera's"},
    {"height", "px"},
    {"frame_rate", "Hz; default: the camera's"},
    {"exposure_us", "microseconds, or auto; default: the camera's"},
    {"controls", "further ones: \"gain=10 focus_absolute=0\""},
    {"bits", "significant bits of Y16, where the camera uses fewer than 16"},
    {"skip", "pictures left out after a start, 2 by default: often dark or torn"},
    {"silence", "s without a picture after which the camera counts as hung, 2 by default"},
    {"buffers", "shared with the kernel, 6 by default"}};

struct V4l2Settings {
  std::string id;
  V4l2Wishes wishes;
  std::map<std::string, std::string> controls;
  PictureKind kind = PictureKind::grey;
  int bits = 0, skip = 2, buffers = 6;
  double silence = 2;
};

constexpr Clock::duration first_picture_patience = std::chrono::seconds(3);
constexpr int most_errors_in_a_row = 30;

class V4l2Camera : public CameraSource {
 public:
  V4l2Camera(V4l2Settings settings, V4l2Device device, V4l2Agreement agreement)
      : settings_(std::move(settings)),
        device_(std::move(device)),
        agreement_(std::move(agreement)),
        v4l2_controls_(device_),
        controls_(v4l2_controls_.read()),
        exposure_(v4l2_controls_.exposure()) {
    CameraStream stream;
    stream.width = agreement_.width;
    stream.height = agreement_.height;
    stream.format = fourcc_text(agreement_.format->fourcc);
    streams_.push_back(std::move(stream));
  }

  const std::vector<CameraStream>& streams() const override { return streams_; }
  std::string description() const override { return device_.description(); }
  double frame_rate() const override { return agreement_.frame_rate; }

  Result<void> start() override {
    if (auto written = v4l2_controls_.write(settings_.controls); !written) return written;
    auto buffers = V4l2Buffers::start(device_, settings_.buffers);
    if (!buffers) return fail(buffers.error());
    buffers_.emplace(std::move(*buffers));
    // Some cameras forget their controls when they start.
    if (auto written = v4l2_controls_.write(settings_.controls); !written) return written;
    refresh();
    to_skip_ = settings_.skip;
    errors_ = 0;
    hung_up_ = false;
    last_sequence_.reset();
    // A camera in the dark may make its exposures, and so its periods, several times longer from one picture
    // to the next: three of the promised ones would be too hasty, and unplugging is told by the kernel at
    // once.
    const double period =
        std::max(agreement_.frame_rate > 0 ? 1 / agreement_.frame_rate : 0, settings_.silence / 3);
    watch_.begin(Clock::now(),
                 std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(period)),
                 first_picture_patience);
    return {};
  }

  void stop() override { buffers_.reset(); }
  void interrupt() noexcept override { stopped_.set(); }

  CameraPoll next(std::chrono::milliseconds timeout) override {
    watch_.look(Clock::now());
    CameraPoll poll = await(Clock::now() + timeout);
    watch_.leave(Clock::now());
    return poll;
  }

  Result<void> set_control(const std::string& name, const std::string& value) override {
    if (auto good = v4l2_controls_.check(name, value); !good) return good;
    thread_.post([this, name, value] {
      const auto written = v4l2_controls_.write(name, value);
      refresh();
      const std::lock_guard lock(mutex_);
      controls_[name].problem = written ? "" : written.error().text();
    });
    return {};
  }
  std::map<std::string, CameraControl> controls() const override {
    const std::lock_guard lock(mutex_);
    return controls_;
  }

  CameraCounters counters() const override {
    CameraCounters counters;
    counters.frames = frames_;
    counters.incomplete = incomplete_;
    counters.missed = missed_;
    return counters;
  }
  std::vector<std::string> warnings() const override {
    return agreement_.warning.empty() ? std::vector<std::string>() : std::vector{agreement_.warning};
  }

 private:
  CameraPoll await(Clock::time_point deadline) {
    for (;;) {
      if (stopped_.is_set()) return {CameraEvent::stopped, {}, {}};
      if (!lost_.empty()) return {CameraEvent::lost, {}, lost_};
      V4l2Buffers::Filled filled;
      const int code = buffers_->take(filled);
      if (code == 0) {
        watch_.sign_of_life(Clock::now());
        auto frame = frame_of(filled);
        if (const int back = buffers_->give_back(filled)) failed("give a buffer back", back);
        if (frame) return {CameraEvent::frame, std::move(*frame), {}};
      } else if (code == EAGAIN && hung_up_) {
        failed("wait for pictures", ENODEV);
      } else if (code != EAGAIN) {
        failed("read a picture", code);
        incomplete_ += lost_.empty();  // who is gone has sent none
      } else if (const auto now = Clock::now(); now >= *watch_.deadline()) {
        const auto silence = watch_.silence(now);
        lost_ = silence ? formatted("no picture for %.1f s", std::chrono::duration<double>(*silence).count())
                        : "no picture came since the start";
      } else if (now >= deadline) {
        return {};
      } else {
        wait(std::min(deadline, *watch_.deadline()));
      }
    }
  }

  void wait(Clock::time_point until) {
    pollfd polled[] = {{device_.fd(), POLLIN, 0}, {stopped_.fd(), POLLIN, 0}};
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now());
    const int ready = ::poll(polled, 2, static_cast<int>(std::clamp<std::int64_t>(left.count(), 0, 60'000)));
    if (ready == 0)
      watch_.overslept(std::max(Clock::duration(0), Clock::now() - until - std::chrono::milliseconds(1)));
    hung_up_ = polled[0].revents & (POLLERR | POLLHUP | POLLNVAL);
  }

  /// An error of the stream. A transient one is forgiven, and what repeats itself or means unplugged is the
  /// end.
  void failed(const char* doing, int code) {
    const bool gone = code == ENODEV || code == ENXIO || code == EBADF;
    if (gone) {
      lost_ = "unplugged";
    } else if (++errors_ >= most_errors_in_a_row) {
      lost_ = v4l2_error(device_.node(), doing, code).problems[0].what;
    }
  }

  std::optional<CameraFrame> frame_of(const V4l2Buffers::Filled& filled) {
    const v4l2_buffer& buffer = filled.buffer;
    if (last_sequence_ && to_skip_ == 0) {
      // 32 bits that wrap around; a stream that began anew is no gap.
      const std::uint32_t step = buffer.sequence - *last_sequence_;
      if (step > 1 && step < 1'000'000) missed_ += step - 1;
    }
    last_sequence_ = buffer.sequence;
    if (to_skip_ > 0) {  // as was asked for: no loss
      --to_skip_;
      return std::nullopt;
    }
    if (buffer.flags & V4L2_BUF_FLAG_ERROR || filled.data.empty()) {
      ++incomplete_;
      return std::nullopt;
    }
    RawPicture raw{agreement_.format, agreement_.width, agreement_.height, agreement_.stride, filled.data};
    raw.bits = settings_.bits;
    raw.full_range = agreement_.full_range;
    raw.memory = &memory_;
    auto image = to_image(raw, settings_.kind);
    if (!image) {
      ++incomplete_;
      return std::nullopt;
    }
    errors_ = 0;
    ++frames_;
    CameraFrame frame;
    frame.image = pool_.keep(*image);
    memory_ = std::move(image->bytes);
    frame.sequence = buffer.sequence;
    stamp(buffer, frame);
    return frame;
  }

  /// The kernel stamps the start of a frame's transfer, which follows the exposure, or its end.
  void stamp(const v4l2_buffer& buffer, CameraFrame& frame) const {
    const double exposure = exposure_;
    const double period = agreement_.frame_rate > 0 ? 1 / agreement_.frame_rate : 0.1;
    const std::chrono::nanoseconds at =
        std::chrono::seconds(buffer.timestamp.tv_sec) + std::chrono::microseconds(buffer.timestamp.tv_usec);
    const bool monotonic = (buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
    const auto now = Clock::now();
    const Clock::time_point stamped{at};
    // The steady clock is CLOCK_MONOTONIC. A stamp far from now is none.
    const bool usable =
        monotonic && stamped > now - std::chrono::seconds(10) && stamped < now + std::chrono::seconds(1);
    frame.time = utc_of(usable ? stamped : now) - std::llround(1e9 * exposure / 2);
    const bool at_start =
        usable && (buffer.flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
    // At the end, the time of the transfer is in it, up to a period; automatic exposure is somewhere below
    // one.
    const double sigma = (at_start ? 0.002 : period / 2) + (exposure > 0 ? 0 : period / 4);
    frame.time_sigma = std::llround(1e9 * sigma);
  }

  void refresh() {
    auto now = v4l2_controls_.read();
    exposure_ = v4l2_controls_.exposure();
    const std::lock_guard lock(mutex_);
    for (auto& [name, control] : now) control.problem = controls_[name].problem;
    controls_ = std::move(now);
  }

  const V4l2Settings settings_;
  const V4l2Device device_;
  const V4l2Agreement agreement_;
  const V4l2Controls v4l2_controls_;
  std::vector<CameraStream> streams_;
  StopEvent stopped_;
  // Of the capture thread:
  std::optional<V4l2Buffers> buffers_;
  FrameWatch watch_;
  SharedPool<Image> pool_;
  std::vector<std::uint8_t> memory_;  ///< of the next picture
  std::string lost_;                  ///< why; empty: it is there
  bool hung_up_ = false;              ///< poll said so; what is wrong, the next buffer tells
  int to_skip_ = 0, errors_ = 0;
  std::optional<std::uint32_t> last_sequence_;
  std::atomic<std::uint64_t> frames_{0}, incomplete_{0}, missed_{0};
  mutable std::mutex mutex_;  ///< of `controls_`
  std::map<std::string, CameraControl> controls_;
  std::atomic<double> exposure_;  ///< s; 0: automatic or not told
  ControlThread thread_;          ///< last: its jobs use the others
};

/// "gain=10 focus_absolute=0".
void read_controls(OptionReader& options, std::map<std::string, std::string>& controls) {
  const std::string text = options.text("controls").value_or("");
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find_first_of(" ,", begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    begin = end + 1;
    if (word.empty()) continue;
    const std::size_t equals = word.find('=');
    if (equals == std::string::npos || equals == 0) {
      options.problem("'controls' has '" + word + "'", "write name=value, with spaces between");
    } else {
      controls[word.substr(0, equals)] = word.substr(equals + 1);
    }
  }
}

Result<V4l2Settings> read_settings(OptionReader& options) {
  V4l2Settings settings;
  settings.id = options.text("id").value_or("");
  settings.wishes.format = options.text("format").value_or("");
  constexpr std::string_view kinds[] = {"grey", "colour"};
  if (options.choice("picture", kinds) == "colour") settings.kind = PictureKind::colour;
  settings.wishes.width = options.integer("width", 1, 30000);
  settings.wishes.height = options.integer("height", 1, 30000);
  settings.wishes.frame_rate = options.number("frame_rate", 0.1, 10000);
  read_controls(options, settings.controls);
  if (const auto exposure = options.text("exposure_us")) {
    if (*exposure != "auto") options.number("exposure_us", 1, 1e9);
    settings.controls["exposure_us"] = *exposure;
  }
  settings.bits = options.integer("bits", 8, 16).value_or(0);
  settings.skip = options.integer("skip", 0, 1000).value_or(settings.skip);
  settings.silence = options.number("silence", 0.1, 3600).value_or(settings.silence);
  settings.buffers = options.integer("buffers", 2, 32).value_or(settings.buffers);
  if (const auto good = options.done(); !good) return fail(good.error());
  return settings;
}

/// The only camera, where none is named.
Result<V4l2Device> find_and_open(const std::string& id) {
  if (!id.empty()) return V4l2Device::open(v4l2_node_of(id));
  std::string there;
  std::optional<V4l2Device> only;
  for (const V4l2Node& node : list_v4l2_nodes()) {
    auto device = V4l2Device::open(node.node);
    if (!device && device.error().code == ErrorCode::config) continue;
    if (!there.empty()) {
      return fail(ErrorCode::unavailable, "v4l2", "there are several cameras",
                  "say which with 'id': " + there + ", " + node.id);
    }
    there = node.id;
    if (!device) return fail(device.error());
    only = std::move(*device);
  }
  if (only) return std::move(*only);
  return fail(ErrorCode::unavailable, "v4l2", "there is no camera",
              "plug one in; `ca2 sensors` lists those that are");
}

Result<std::unique_ptr<CameraSource>> open(OptionReader& options) {
  auto settings = read_settings(options);
  if (!settings) return fail(settings.error());
  auto device = find_and_open(settings->id);
  if (!device) return fail(device.error());
  auto agreement = negotiate(*device, settings->wishes);
  if (!agreement) return fail(agreement.error());
  const V4l2Controls controls(*device);
  for (const auto& [name, value] : settings->controls) {
    if (auto good = controls.check(name, value); !good) return fail(ErrorCode::config, good.error().problems);
  }
  return std::make_unique<V4l2Camera>(std::move(*settings), std::move(*device), std::move(*agreement));
}

Result<std::vector<FoundCamera>> list() {
  std::vector<FoundCamera> found;
  for (const V4l2Node& node : list_v4l2_nodes()) {
    FoundCamera camera;
    camera.driver = "v4l2";
    camera.id = node.id;
    camera.source = {{"driver", "v4l2"}, {"id", node.id}};
    const auto device = V4l2Device::open(node.node);
    if (device) {
      camera.description =
          device->description() + " at " + node.node.string() + ": " + v4l2_abilities(*device);
    } else if (device.error().code == ErrorCode::config) {
      continue;
    } else {
      camera.description = node.node.string();
      camera.problem = device.error().text();
    }
    found.push_back(std::move(camera));
  }
  return found;
}

}  // namespace

const CameraDriver& v4l2_camera_driver() {
  static const CameraDriver driver{"v4l2", "USB (UVC) and other cameras of the kernel's drivers",
                                   options_known, open, list};
  return driver;
}

}  // namespace ca2
