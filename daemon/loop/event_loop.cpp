#include "daemon/loop/event_loop.h"

#include <sys/epoll.h>
#include <sys/eventfd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

namespace ca2 {
namespace {

using Clock = std::chrono::steady_clock;

void check(bool good, const char* what) {
  if (!good) throw std::system_error(errno, std::generic_category(), what);
}

}  // namespace

EventLoop::EventLoop()
    : epoll_(::epoll_create1(EPOLL_CLOEXEC)), wake_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  check(epoll_.valid() && wake_.valid(), "event loop");
  watch(wake_.get(), EPOLLIN, [this](std::uint32_t) {
    std::uint64_t count = 0;
    [[maybe_unused]] const auto size = ::read(wake_.get(), &count, sizeof(count));
    run_posted();
  });
}

void EventLoop::watch(int fd, std::uint32_t events, Handler handler) {
  epoll_event event{};
  event.events = events;
  event.data.fd = fd;
  check(::epoll_ctl(epoll_.get(), EPOLL_CTL_ADD, fd, &event) == 0, "epoll_ctl");
  handlers_[fd] = std::make_shared<Handler>(std::move(handler));
}

void EventLoop::change(int fd, std::uint32_t events) {
  epoll_event event{};
  event.events = events;
  event.data.fd = fd;
  check(::epoll_ctl(epoll_.get(), EPOLL_CTL_MOD, fd, &event) == 0, "epoll_ctl");
}

void EventLoop::forget(int fd) {
  handlers_.erase(fd);
  ::epoll_ctl(epoll_.get(), EPOLL_CTL_DEL, fd, nullptr);
}

void EventLoop::every(std::chrono::milliseconds period, Task task) {
  timers_.push_back(std::make_unique<Timer>(Timer{Clock::now() + period, period, std::move(task)}));
}

bool EventLoop::add(Task& task, std::unique_lock<std::mutex>& lock) {
  if (closed_ || posted_.size() >= max_posted) return false;
  posted_.push_back(std::move(task));
  const bool first = posted_.size() == 1;
  lock.unlock();
  const std::uint64_t one = 1;
  if (first) [[maybe_unused]]
    const auto written = ::write(wake_.get(), &one, sizeof(one));
  return true;
}

bool EventLoop::post(Task task) {
  std::unique_lock lock(mutex_);
  room_.wait(lock, [&] { return closed_ || posted_.size() < max_posted; });
  return add(task, lock);
}

bool EventLoop::try_post(Task task) {
  std::unique_lock lock(mutex_);
  return add(task, lock);
}

void EventLoop::run_posted() {
  std::deque<Task> tasks;
  {
    const std::lock_guard lock(mutex_);
    tasks.swap(posted_);
  }
  room_.notify_all();
  for (Task& task : tasks) task();
}

int EventLoop::until_next_timer() const {
  auto next = Clock::now() + std::chrono::seconds(1);
  for (const auto& timer : timers_) next = std::min(next, timer->next);
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(next - Clock::now()).count();
  return static_cast<int>(std::max<std::int64_t>(0, left));
}

void EventLoop::run_timers() {
  const auto now = Clock::now();
  // By index: a task may add a timer.
  for (std::size_t i = 0; i < timers_.size(); ++i) {
    Timer& timer = *timers_[i];
    if (timer.next > now) continue;
    // What was missed while the loop was held up is not made up for.
    timer.next = std::max(timer.next + timer.period, now);
    timer.task();
  }
}

void EventLoop::run() {
  while (running_) {
    epoll_event events[32];
    const int count = ::epoll_wait(epoll_.get(), events, std::size(events), until_next_timer());
    check(count >= 0 || errno == EINTR, "epoll_wait");
    for (int i = 0; i < count && running_; ++i) {
      const auto handler = handlers_.find(events[i].data.fd);
      // Held while it runs: it may forget itself.
      if (handler == handlers_.end()) continue;
      const std::shared_ptr<Handler> held = handler->second;
      (*held)(events[i].events);
    }
    run_timers();
  }
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    posted_.clear();
  }
  room_.notify_all();
}

}  // namespace ca2
