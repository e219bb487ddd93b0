#include "daemon/daemon.h"

#include <sys/epoll.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "ca2_version.h"
#include "core/types/text.h"
#include "daemon/capture/state_lock.h"
#include "daemon/log.h"
#include "daemon/notify.h"
#include "daemon/sensors/ouster_metadata.h"
#include "daemon/signals.h"
#include "messages/status.h"

namespace ca2 {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds tick_period{50}, status_period{200}, extrinsics_period{1000};
constexpr milliseconds loop_beat_within{5000};
constexpr milliseconds longest_goodbye{1000};  // for what is being written

Config ready_for_sensors(Config config) {
  config.rig = with_kept_metadata(std::move(config.rig), config.options.state_directory);
  return config;
}

}  // namespace

Daemon::Daemon(Config config, std::optional<Recording> recording, ReadAgain read_again)
    : config_(ready_for_sensors(std::move(config))),
      recording_(std::move(recording)),
      read_again_(std::move(read_again)),
      clock_(recording_ ? std::optional(recording_->start) : std::nullopt),
      loop_beat_(heartbeats_.add("event loop")),
      previews_(loop_, heartbeats_),
      recorder_(loop_, heartbeats_, config_.options.state_directory, [this] { return clock_.now(); }),
      reaper_("reaper", heartbeats_, 16, std::chrono::seconds(60)) {
  if (!recording_) return;
  recorder_.set_caveat("the sensors are a recording: its pictures are recorded again, its packets are in " +
                       (recording_->directory / "lidars").string() + " only");
}

Daemon::~Daemon() {
  retire_sensors();
}

Result<void> Daemon::open() {
  const auto handler = [this](const std::string& origin, const std::string& command,
                              const nlohmann::json& arguments, CommandAnswer answer) {
    dispatch({*capture_, recorder_, previews_, [this] { return status(); }}, origin, command, arguments,
             std::move(answer));
  };
  auto door = SocketDoor::open(loop_, config_.options.control_socket, handler);
  if (!door) return fail(door.error());
  socket_door_ = std::move(*door);
  auto state = lock_state(config_.options.state_directory);
  if (!state) return fail(state.error());
  state_ = std::move(*state);
  if (config_.options.lcm_enabled) {
    if (const auto opened = open_lcm(); !opened) return opened;
    if (auto keys = read_keys(config_.options.command_keys); !keys.empty()) {
      log::info("control", formatted("commands over LCM for %zu senders", keys.size()));
      lcm_door_ = std::make_unique<LcmDoor>(*lcm_, std::move(keys), handler);
    }
  }
  CaptureHost::Listener listener;
  listener.event = [this](const CaptureEvent& event) { socket_door_->send_event(event.kind, event.text); };
  listener.view = [this](int id, bool stored) {
    if (publisher_) publisher_->view(capture_->session(), id, stored, capture_->status().views, clock_.now());
  };
  listener.changed = [this] { next_status_ = {}; };
  capture_ = std::make_unique<CaptureHost>(
      loop_, heartbeats_, config_, [this] { return clock_.now(); }, std::move(listener));
  start_sensors();
  hear_signals();
  loop_.every(tick_period, [this] { tick(); });
  if (const auto period = notify::watchdog_period()) {
    loop_.every(*period / 4, [this] { feed_watchdog(); });
  }
  return {};
}

Result<void> Daemon::open_lcm() {
  lcm_ = std::make_unique<lcm::LCM>(config_.options.lcm_url);
  if (!lcm_->good()) {
    return fail(ErrorCode::unavailable, "lcm.url", "LCM cannot use " + config_.options.lcm_url,
                "it needs a route for multicast, on this host alone: ip route add 224.0.0.0/4 dev lo; or set "
                "lcm.enabled: false");
  }
  publisher_ = std::make_unique<LcmPublisher>(*lcm_);
  loop_.watch(lcm_->getFileno(), EPOLLIN, [this](std::uint32_t) { lcm_->handle(); });
  return {};
}

void Daemon::start_sensors() {
  current_ = std::make_shared<bool>(true);
  previews_.set_rig(config_.rig);
  recorder_.set_rig(capture_->rig());
  healths_.clear();
  const auto wanted = current_;
  ObservationSink sink;
  sink.camera = [this, wanted](CameraObservation observation) {
    loop_.post([this, wanted, observation = std::move(observation)] {
      if (!*wanted) return;
      previews_.add(observation);
      capture_->add(observation);
    });
  };
  sink.lidar = [this, wanted](LidarObservation observation) {
    loop_.post([this, wanted, observation = std::move(observation)] {
      if (!*wanted) return;
      previews_.add(observation);
      capture_->add(observation);
    });
  };
  const auto healths = [this, wanted](SensorHealths news) {
    loop_.post([this, wanted, news = std::move(news)] {
      for (const auto& [name, health] : news) {
        if (*wanted) healths_[name] = health;
      }
    });
  };
  sensors_ =
      std::make_shared<SensorSet>(config_, recording_, recorder_, std::move(sink), healths, heartbeats_);
}

/// Their threads may take seconds to end; somebody else waits for them.
void Daemon::retire_sensors() {
  if (!sensors_) return;
  *current_ = false;
  sensors_->stop();
  reaper_.submit([old = std::move(sensors_)]() mutable { old.reset(); });
}

/// All or nothing.
void Daemon::reload() {
  notify::reloading();
  const auto done = [&](const std::string& text, bool good) {
    good ? log::info("config", text) : log::error("config", text);
    heard(good ? "reloaded" : "not reloaded", text);
    notify::ready();
  };
  Result<Config> config = read_again_();
  if (!config) return done("the old configuration stays:\n" + config.error().text(), false);
  const auto restart = needs_restart(config_.options, config->options);
  if (!restart.empty()) {
    std::string names;
    for (const std::string& name : restart) names += (names.empty() ? "" : ", ") + name;
    return done("the old configuration stays: " + names + " can only change with a restart", false);
  }
  if (!recorder_.directory().empty()) return done("the old configuration stays while recording", false);
  if (!capture_->idle()) return done("the old configuration stays while a view is being written", false);
  config_ = ready_for_sensors(std::move(*config));
  if (recording_) {  // its rig is the old one, and it plays on
    capture_->restart(config_);
    return done("the options are reloaded; rig and sensors stay the recording's", true);
  }
  retire_sensors();
  capture_->restart(config_);
  start_sensors();
  done("reloaded " + config_.file.string(), true);
}

void Daemon::hear_signals() {
  signals_ = signal_descriptor();
  loop_.watch(signals_.get(), EPOLLIN, [this](std::uint32_t) {
    switch (next_signal(signals_)) {
      case SIGHUP:
        return reload();
      case SIGTERM:
      case SIGINT:
        return begin_stop();
      default:
        return;
    }
  });
}

void Daemon::begin_stop() {
  if (stopping_until_) return loop_.stop();  // asked twice
  log::info("daemon", "stopping");
  notify::stopping();
  stopping_until_ = Clock::now() + longest_goodbye;
  retire_sensors();
  if (!recorder_.directory().empty()) recorder_.stop([](const Result<RecordingSummary>&) {});
}

void Daemon::tick() {
  loop_beat_->beat(loop_beat_within);
  if (stopping_until_) {
    if ((capture_->idle() && recorder_.idle()) || Clock::now() > *stopping_until_) loop_.stop();
    return;
  }
  if (const auto jump = clock_.jump()) {
    const std::string text = formatted("the system's clock was set by %+.1f s: stillness begins anew",
                                       1e-9 * static_cast<double>(*jump));
    log::warning("daemon", text);
    heard("clock", text);
    restart_wanted_ = true;
  }
  if (restart_wanted_ && capture_->idle()) {
    restart_wanted_ = false;
    // Detectors and sensors' clocks remember times of before, too.
    retire_sensors();
    capture_->restart(config_);
    start_sensors();
  }
  capture_->tick();
  publish_if_due();
  publish_previews();
}

DaemonStatus Daemon::status() {
  DaemonStatus status;
  status.time = clock_.now();
  status.sequence = sequence_;
  status.software = "ca2 " CA2_VERSION;
  status.session = capture_->session();
  status.capture = capture_->status();
  status.sensors = healths_;
  status.solving = capture_->solving();
  status.storage_problem = capture_->storage_problem();
  status.recording = recorder_.directory();
  status.recording_dropped = recorder_.dropped();
  status.store_cost = capture_->store_cost();
  status.refused_commands = lcm_door_ ? lcm_door_->refused() : 0;
  return status;
}

/// What is to be seen at once, not only with the next regular status.
static std::string gist(const DaemonStatus& status) {
  std::string out = formatted("%d|%d|", static_cast<int>(status.capture.state), status.capture.views) +
                    status.capture.last_event + "|" + status.storage_problem + "|" + status.recording;
  for (const SensorStatus& sensor : status.capture.sensors) {
    out += sensor.silent ? "|silent" : sensor.sees_board ? "|board" : "|";
  }
  for (const auto& [name, health] : status.sensors) out += "|" + health.problem;
  return out;
}

void Daemon::publish_if_due() {
  const auto now = Clock::now();
  DaemonStatus status = this->status();
  std::string gist_now = gist(status);
  if (gist_now == published_ && now < next_status_) return;
  next_status_ = now + status_period;
  status.sequence = ++sequence_;
  if (publisher_) publisher_->status(status);
  if (socket_door_->has_subscribers()) socket_door_->send_status(to_json(status));
  if (gist_now != published_) {
    notify::status(std::string(state_name(status.capture.state)) + ": " + status.capture.reason);
    published_ = std::move(gist_now);
    next_extrinsics_ = {};
  }
  if (publisher_ && capture_->calibration() && now >= next_extrinsics_) {
    publisher_->extrinsics(*capture_->calibration(), capture_->session(), capture_->solved_time());
    next_extrinsics_ = now + extrinsics_period;
  }
}

/// One sensor after the other, so that a slow link never gets all at once.
void Daemon::publish_previews() {
  const double rate = config_.options.preview_rate * static_cast<double>(previews_.sensors().size());
  if (!publisher_ || rate <= 0 || Clock::now() < next_preview_) return;
  next_preview_ = Clock::now() + milliseconds(static_cast<std::int64_t>(std::min(1000 / rate, 1e9)));
  const std::string& sensor = previews_.sensors()[preview_turn_++ % previews_.sensors().size()];
  previews_.make(sensor, static_cast<int>(config_.options.preview_width),
                 [this, sensor](const Result<Preview>& preview) {
                   if (preview) publisher_->preview(sensor, *preview);
                 });
}

void Daemon::feed_watchdog() {
  loop_beat_->beat(loop_beat_within);
  const std::string late = heartbeats_.late().value_or("");
  if (late.empty()) notify::watchdog();
  if (!late.empty() && late != late_thread_) {
    log::error("daemon", late + " is stuck: the watchdog is no longer fed");
  }
  late_thread_ = late;
}

void Daemon::heard(const std::string& kind, const std::string& text) {
  socket_door_->send_event(kind, text);
}

void Daemon::run() {
  log::info("daemon", "ca2 " CA2_VERSION " runs, control socket " + config_.options.control_socket);
  notify::ready();
  loop_.run();
}

}  // namespace ca2
