#include "daemon/sensors/supervisor.h"

#include "daemon/log.h"
#include "daemon/work/thread_name.h"

namespace ca2 {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds first_wait{500}, longest_wait{8000};
constexpr std::chrono::seconds steady_after{10};  // running for so long, a sensor is trusted again
constexpr milliseconds report_period{500};
// Discovery, opening and closing of a GigE camera that has gone block for up to 10 s.
constexpr std::chrono::seconds longest_open{45}, longest_step{20};

std::string names_of(const SensorDevice& device) {
  std::string names;
  for (const auto& [name, health] : device.health()) names += (names.empty() ? "" : "+") + name;
  return names;
}

}  // namespace

Supervisor::Supervisor(std::unique_ptr<SensorDevice> device, std::function<void(SensorHealths)> report,
                       Heartbeats& heartbeats)
    : device_(std::move(device)), report_(std::move(report)), name_(names_of(*device_)) {
  heartbeat_ = heartbeats.add("sensor " + name_);
  thread_ = std::thread([this] {
    name_thread("ca2:" + name_);
    run();
  });
}

Supervisor::~Supervisor() {
  stop();
  thread_.join();
}

void Supervisor::stop() noexcept {
  stop_.set();
  device_->interrupt();
}

void Supervisor::report(const char* supervision, const std::string& problem) {
  SensorHealths healths = device_->health();
  for (auto& [name, health] : healths) {
    health.supervision = supervision;
    health.problem = problem;
    health.reopened = reopened_;
  }
  report_(std::move(healths));
  if (problem == last_problem_) return;
  if (problem.empty()) {
    log::info("sensor", name_ + " runs: " + device_->health().begin()->second.device);
  } else {
    log::warning("sensor", name_ + ": " + problem);
  }
  last_problem_ = problem;
}

void Supervisor::run() {
  milliseconds wait = first_wait;
  last_problem_ = "not opened yet";
  while (!stop_.is_set()) {
    heartbeat_->beat(longest_open);
    const Result<void> opened = device_->open();
    const auto start = Clock::now();
    if (opened) {
      read();
      heartbeat_->beat(longest_open);
      device_->close();
      ++reopened_;
      if (Clock::now() - start > steady_after) wait = first_wait;
    } else {
      report("retrying", opened.error().text());
    }
    heartbeat_->beat(longest_wait + longest_step);
    stop_.wait_until(Clock::now() + wait);
    wait = std::min(2 * wait, longest_wait);
  }
}

void Supervisor::read() {
  report("running", "");
  auto next_report = Clock::now() + report_period;
  while (!stop_.is_set()) {
    heartbeat_->beat(longest_step);
    const SensorDevice::Step step = device_->step();
    if (step.event == SensorDevice::Event::lost) {
      if (!stop_.is_set()) report("retrying", step.reason);
      return;
    }
    if (step.event == SensorDevice::Event::ended) {
      report("running", "the recording is over");
      heartbeat_->beat(std::chrono::hours(24 * 365));  // nothing is expected of it any more
      stop_.wait_until(Clock::time_point::max());
      return;
    }
    if (Clock::now() >= next_report) {
      report("running", "");
      next_report = Clock::now() + report_period;
    }
  }
}

}  // namespace ca2
