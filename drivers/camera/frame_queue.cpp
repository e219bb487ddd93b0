#include "drivers/camera/frame_queue.h"

namespace ca2 {

void FrameQueue::restart() {
  const std::lock_guard lock(mutex_);
  frames_.clear();
  lost_.clear();
}

void FrameQueue::push(CameraFrame frame) {
  const std::lock_guard lock(mutex_);
  if (frames_.size() >= limit_) {
    frames_.pop_front();
    ++overrun_;
  }
  frames_.push_back(std::move(frame));
  changed_.notify_one();
}

void FrameQueue::lose(std::string reason) {
  const std::lock_guard lock(mutex_);
  if (lost_.empty()) lost_ = std::move(reason);
  changed_.notify_one();
}

void FrameQueue::interrupt() noexcept {
  const std::lock_guard lock(mutex_);
  interrupted_ = true;
  changed_.notify_one();
}

CameraPoll FrameQueue::pop(std::chrono::steady_clock::time_point deadline) {
  std::unique_lock lock(mutex_);
  changed_.wait_until(lock, deadline, [&] { return interrupted_ || !frames_.empty() || !lost_.empty(); });
  if (interrupted_) return {CameraEvent::stopped, {}, {}};
  if (!frames_.empty()) {
    CameraPoll out{CameraEvent::frame, std::move(frames_.front()), {}};
    frames_.pop_front();
    ++delivered_;
    return out;
  }
  if (!lost_.empty()) return {CameraEvent::lost, {}, lost_};
  return {};
}

std::uint64_t FrameQueue::delivered() const {
  const std::lock_guard lock(mutex_);
  return delivered_;
}

std::uint64_t FrameQueue::overrun() const {
  const std::lock_guard lock(mutex_);
  return overrun_;
}

}  // namespace ca2
