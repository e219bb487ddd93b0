#include "drivers/camera/t265/t265_camera.h"

#include <algorithm>
#include <cmath>

#include "core/types/text.h"
#include "drivers/camera/host_time.h"
#include "drivers/camera/option_reader.h"

namespace ca2::t265 {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr milliseconds clock_period{500};    // between readings of the device's clock
constexpr int first_readings = 5;            // before the first picture is stamped
constexpr milliseconds first_picture{2000};  // beyond the silence: the start takes a while
constexpr milliseconds last_words{200};      // for what was on its way when it stopped
constexpr std::string_view controls_known[] = {"exposure_us", "gain_db"};

double decibels(double factor) {
  return factor > 0 ? 20 * std::log10(factor) : 0;
}

}  // namespace

Result<std::unique_ptr<T265Camera>> T265Camera::create(std::unique_ptr<Device> device,
                                                       const CameraOptions& options) {
  const auto left = device->calibration(Sensor::left);
  if (!left) return fail(left.error());
  const auto right = device->calibration(Sensor::right);
  if (!right) return fail(right.error());
  auto streams = camera_streams(*left, *right);
  if (!streams) return fail(streams.error());
  auto entries = device->fisheye_streams();
  if (!entries) return fail(entries.error());
  for (std::size_t i = 0; i < 2; ++i) {
    const StreamEntry& entry = (*entries)[i];
    const CameraStream& stream = (*streams)[i];
    if (entry.width != stream.width || entry.height != stream.height) {
      return fail(ErrorCode::data, "T265, " + stream.name + " imager",
                  formatted("sends %u x %u pixels and is calibrated for %d x %d", unsigned{entry.width},
                            unsigned{entry.height}, stream.width, stream.height));
    }
  }
  return std::unique_ptr<T265Camera>(
      new T265Camera(std::move(device), options, std::move(*streams), std::move(*entries)));
}

T265Camera::T265Camera(std::unique_ptr<Device> device, const CameraOptions& options,
                       std::vector<CameraStream> streams, std::vector<StreamEntry> entries)
    : device_(std::move(device)),
      options_(options),
      streams_(std::move(streams)),
      entries_(std::move(entries)),
      rate_(entries_[0].rate),
      exposure_(options.exposure) {}

T265Camera::~T265Camera() {
  stop();
}

std::string T265Camera::description() const {
  const UsbDeviceInfo& usb = device_->usb().info();
  std::string text = "Intel RealSense T265, serial " + device_->info().serial + ", firmware " +
                     device_->info().firmware + ", USB " + usb.port;
  if (usb.megabits > 0 && usb.megabits < 5000) {
    text += formatted(" (%d Mbit/s: too slow for every picture, use a USB 3 port)", usb.megabits);
  }
  return text;
}

Result<void> T265Camera::start() {
  if (started_) return {};
  queue_.restart();
  lost_ = pictured_ = false;
  counts_[0] = counts_[1] = {};
  {
    const std::lock_guard lock(mutex_);
    time_ = {};
    stopping_ = stopped_ = false;
    exposure_due_ = !exposure_.automatic;
  }
  if (auto ready = device_->configure(entries_, options_.exposure.automatic); !ready) return ready;
  for (int i = 0; i < first_readings; ++i) {
    const auto reading = device_->time();
    if (!reading) return fail(reading.error());
    begin_ = reading->device;
    const std::lock_guard lock(mutex_);
    time_.add(reading->device, utc_of(reading->sent), utc_of(reading->received));
  }
  const auto ended = [this](UsbOutcome outcome) { queue_.lose(text_of(outcome)); };
  const auto got = [this](ByteSpan bytes) { received(bytes); };
  // The readers wait before the first picture is there. Room for a picture, in whole USB 3 packets.
  const std::size_t picture = picture_header + std::size_t{entries_[0].width} * entries_[0].height;
  pictures_ = std::make_unique<UsbReader>(
      device_->usb(), UsbReaderOptions{picture_endpoint, false, 8, (picture / 1024 + 1) * 1024}, got, ended);
  events_ = std::make_unique<UsbReader>(device_->usb(), UsbReaderOptions{event_endpoint, true, 2, 1024}, got,
                                        ended);
  watch_.begin(Clock::now(), options_.silence / 3, first_picture);
  started_ = true;
  if (auto running = device_->start(); !running) {
    stop();
    return running;
  }
  keeper_ = std::thread([this] { keep(); });
  return {};
}

void T265Camera::stop() {
  if (!started_) return;
  started_ = false;
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    changed_.notify_all();
  }
  if (keeper_.joinable()) keeper_.join();
  // Reading goes on meanwhile: a device that cannot get rid of its pictures does not hear. Who is gone or
  // hangs is not asked: that would take the whole time of a request.
  if (!lost_ && device_->stop()) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, last_words, [&] { return stopped_; });
  }
  pictures_.reset();
  events_.reset();
}

CameraPoll T265Camera::next(milliseconds timeout) {
  const auto deadline = Clock::now() + timeout;
  watch_.look(Clock::now());
  CameraPoll poll;
  for (;;) {
    const auto until = started_ ? std::min(deadline, *watch_.deadline()) : deadline;
    poll = queue_.pop(until);
    const auto now = Clock::now();
    if (poll.event == CameraEvent::frame) watch_.sign_of_life(now);
    lost_ = lost_ || poll.event == CameraEvent::lost;
    if (poll.event != CameraEvent::timeout) break;
    watch_.overslept(std::max(Clock::duration(0), now - until - milliseconds(1)));
    if (started_ && now >= *watch_.deadline()) {
      const auto silence = watch_.silence(now);
      queue_.lose(silence
                      ? formatted("no picture for %.3f s", std::chrono::duration<double>(*silence).count())
                      : std::string("no picture came"));
    } else if (now >= deadline) {
      break;
    }
  }
  watch_.leave(Clock::now());
  return poll;
}

void T265Camera::received(ByteSpan bytes) {
  if (bytes.empty()) {
    queue_.lose("an empty message: the device has stopped");
    return;
  }
  const StreamMessage message = parse_stream(bytes);
  if (std::holds_alternative<Damaged>(message)) ++losses_[0].incomplete;
  if (const auto* picture = std::get_if<Picture>(&message)) deliver(*picture);
  if (const auto* event = std::get_if<Event>(&message)) happened(*event);
}

void T265Camera::deliver(const Picture& picture) {
  const int stream = picture.imager == Sensor::left ? 0 : 1;
  const StreamEntry& entry = entries_[static_cast<std::size_t>(stream)];
  if (picture.pixels.size() != std::size_t{entry.width} * entry.height) {
    ++losses_[stream].incomplete;
    return;
  }
  if (picture.time < begin_) return;
  CameraFrame frame;
  {
    const std::lock_guard lock(mutex_);
    seen_exposure_ = picture.exposure;
    seen_gain_ = picture.gain;
    const auto stamp = time_.at(picture.time);
    if (!stamp) return;
    frame.time = stamp->time;
    frame.time_sigma = stamp->sigma;
  }
  losses_[stream].missed += counts_[stream].missing_before(picture.number);
  pictured_ = true;
  frame.stream = stream;
  frame.sequence = picture.number;
  Image image{entry.width, entry.height, 1, 8, std::move(memory_)};
  image.bytes.assign(picture.pixels.begin(), picture.pixels.end());
  frame.image = pool_.keep(image);
  memory_ = std::move(image.bytes);
  queue_.push(std::move(frame));
}

void T265Camera::happened(const Event& event) {
  if (event.message != Message::status) return;  // tracking's troubles are not ours
  {
    const std::lock_guard lock(mutex_);
    if (event.status == Status::stopped) stopped_ = true;
    changed_.notify_all();
    if (stopping_) return;
  }
  switch (event.status) {
    case Status::stopped:
      // Before the first picture it is the last word of an earlier run.
      if (!pictured_) break;
      [[fallthrough]];
    case Status::temperature_stop:
    case Status::reset:
      queue_.lose(std::string("the device says ") + name_of(event.status));
      break;
    default:
      break;
  }
}

void T265Camera::keep() {
  std::unique_lock lock(mutex_);
  auto due = Clock::now() + clock_period;
  for (;;) {
    changed_.wait_until(lock, due, [&] { return stopping_ || exposure_due_; });
    if (stopping_) return;
    lock.unlock();
    write_exposure();
    if (Clock::now() >= due) {
      due += clock_period;
      // A reading that fails is one less; a device that is gone or hangs is noticed by its pictures.
      if (const auto reading = device_->time()) {
        const std::lock_guard guard(mutex_);
        time_.add(reading->device, utc_of(reading->sent), utc_of(reading->received));
      }
      due = std::max(due, Clock::now());
    }
    lock.lock();
  }
}

void T265Camera::write_exposure() {
  Exposure wanted;
  {
    const std::lock_guard lock(mutex_);
    if (!exposure_due_) return;
    exposure_due_ = false;
    wanted = exposure_;
  }
  const auto written = device_->set_exposure(static_cast<std::uint32_t>(std::lround(wanted.time)),
                                             static_cast<float>(std::pow(10, wanted.gain / 20)));
  const std::lock_guard lock(mutex_);
  exposure_problem_ = written ? "" : written.error().text();
}

Result<void> T265Camera::set_control(const std::string& name, const std::string& value) {
  OptionReader reader({{name, value}}, controls_known);
  const auto time = reader.number("exposure_us", least_exposure, most_exposure);
  const auto gain = reader.number("gain_db", 0, most_gain);
  if (options_.exposure.automatic && (time || gain)) {
    reader.problem("exposure is automatic", "set 'exposure_us' in the camera's source");
  }
  if (const auto good = reader.done(); !good) return good;
  const std::lock_guard lock(mutex_);
  if (time) exposure_.time = *time;
  if (gain) exposure_.gain = *gain;
  exposure_due_ = true;
  changed_.notify_all();
  return {};
}

std::map<std::string, CameraControl> T265Camera::controls() const {
  const std::lock_guard lock(mutex_);
  const bool automatic = options_.exposure.automatic;
  return {
      {"exposure_us",
       {formatted("%u", seen_exposure_),
        automatic ? "automatic" : formatted("%g to %g", least_exposure, most_exposure), exposure_problem_}},
      {"gain_db",
       {formatted("%.2f", decibels(seen_gain_)), automatic ? "automatic" : formatted("0 to %g", most_gain),
        exposure_problem_}}};
}

CameraCounters T265Camera::counters() const {
  CameraCounters all = counters_of(0);
  const CameraCounters right = counters_of(1);
  all.frames += right.frames;
  all.overrun += right.overrun;
  all.incomplete += right.incomplete;
  all.missed += right.missed;
  return all;
}

CameraCounters T265Camera::counters_of(int stream) const {
  CameraCounters out;
  out.frames = queue_.delivered(stream);
  out.overrun = queue_.overrun(stream);
  out.incomplete = losses_[stream].incomplete;
  out.missed = losses_[stream].missed;
  return out;
}

}  // namespace ca2::t265
