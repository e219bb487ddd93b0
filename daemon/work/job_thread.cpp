#include "daemon/work/job_thread.h"

#include "daemon/work/thread_name.h"

namespace ca2 {
namespace {

constexpr std::chrono::milliseconds idle_beat{500}, beat_margin{2000};

}  // namespace

JobThread::JobThread(const std::string& name, Heartbeats& heartbeats, std::size_t capacity,
                     std::chrono::seconds longest, Urgency urgency)
    : capacity_(capacity),
      longest_(longest),
      heartbeat_(heartbeats.add(name)),
      thread_([this, name, urgency] {
        name_thread("ca2-" + name);
        if (urgency == Urgency::can_wait) let_receivers_go_first();
        run();
      }) {}

JobThread::~JobThread() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
    current_.request_stop();
  }
  wake_.notify_all();
  thread_.join();
}

bool JobThread::submit(Job job) {
  {
    const std::lock_guard lock(mutex_);
    if (jobs_.size() >= capacity_) return false;
    jobs_.push_back([job = std::move(job)](const std::stop_token&) { job(); });
  }
  wake_.notify_one();
  return true;
}

void JobThread::replace(StoppableJob job) {
  {
    const std::lock_guard lock(mutex_);
    jobs_.clear();
    if (busy_) current_.request_stop();
    jobs_.push_back(std::move(job));
  }
  wake_.notify_one();
}

bool JobThread::idle() const {
  const std::lock_guard lock(mutex_);
  return jobs_.empty() && !busy_;
}

void JobThread::run() {
  std::unique_lock lock(mutex_);
  while (!stop_) {
    heartbeat_->beat(idle_beat + beat_margin);
    if (!wake_.wait_for(lock, idle_beat, [&] { return stop_ || !jobs_.empty(); }) || stop_) continue;
    {
      const StoppableJob job = std::move(jobs_.front());
      jobs_.pop_front();
      busy_ = true;
      current_ = std::stop_source();
      const std::stop_token stop = current_.get_token();
      lock.unlock();
      heartbeat_->beat(longest_);
      job(stop);
    }  // what the job holds is given back outside the lock
    lock.lock();
    busy_ = false;
  }
}

}  // namespace ca2
