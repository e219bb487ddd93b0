#include "drivers/camera/frame_queue.h"

namespace ca2 {
namespace {

std::uint64_t count_of(const std::map<int, std::uint64_t>& counts, int stream) {
  const auto found = counts.find(stream);
  return found == counts.end() ? 0 : found->second;
}

}  // namespace

void FrameQueue::restart() {
  const std::lock_guard lock(mutex_);
  frames_.clear();
  lost_.clear();
}

void FrameQueue::push(CameraFrame frame) {
  const std::lock_guard lock(mutex_);
  if (frames_.size() >= limit_) {
    ++overrun_[frames_.front().stream];
    frames_.pop_front();
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
    ++delivered_[out.frame.stream];
    return out;
  }
  if (!lost_.empty()) return {CameraEvent::lost, {}, lost_};
  return {};
}

std::uint64_t FrameQueue::delivered(int stream) const {
  const std::lock_guard lock(mutex_);
  return count_of(delivered_, stream);
}

std::uint64_t FrameQueue::overrun(int stream) const {
  const std::lock_guard lock(mutex_);
  return count_of(overrun_, stream);
}

}  // namespace ca2
