#include "drivers/camera/v4l2/buffers.h"

#include <sys/mman.h>

#include <algorithm>
#include <utility>

namespace ca2 {
namespace {

constexpr __u32 least_buffers = 2;  // one that is filled while the other is read

v4l2_buffer blank(std::size_t index) {
  v4l2_buffer buffer{};
  buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  buffer.memory = V4L2_MEMORY_MMAP;
  buffer.index = static_cast<__u32>(index);
  return buffer;
}

int request(const V4l2Device& device, __u32& count) {
  v4l2_requestbuffers buffers{};
  buffers.count = count;
  buffers.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  buffers.memory = V4L2_MEMORY_MMAP;
  const int code = device.call(VIDIOC_REQBUFS, &buffers);
  count = buffers.count;
  return code;
}

}  // namespace

Result<void> V4l2Buffers::map(int wanted) {
  auto count = static_cast<__u32>(wanted);
  if (const int code = request(*device_, count))
    return fail(v4l2_error(device_->node(), "get buffers", code));
  if (count < least_buffers) return fail(v4l2_error(device_->node(), "get two buffers", ENOMEM));
  for (std::size_t i = 0; i < count; ++i) {
    v4l2_buffer buffer = blank(i);
    if (const int code = device_->call(VIDIOC_QUERYBUF, &buffer)) {
      return fail(v4l2_error(device_->node(), "look at its buffers", code));
    }
    void* memory =
        ::mmap(nullptr, buffer.length, PROT_READ | PROT_WRITE, MAP_SHARED, device_->fd(), buffer.m.offset);
    if (memory == MAP_FAILED) return fail(v4l2_error(device_->node(), "map its buffers", errno));
    mapped_.push_back({memory, buffer.length});
    if (const int code = device_->call(VIDIOC_QBUF, &buffer)) {
      return fail(v4l2_error(device_->node(), "queue a buffer", code));
    }
  }
  return {};
}

Result<V4l2Buffers> V4l2Buffers::start(const V4l2Device& device, int wanted) {
  V4l2Buffers buffers(device);
  if (auto mapped = buffers.map(wanted); !mapped) return fail(mapped.error());
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (const int code = device.call(VIDIOC_STREAMON, &type))
    return fail(v4l2_error(device.node(), "start", code));
  return buffers;
}

V4l2Buffers::V4l2Buffers(V4l2Buffers&& other) noexcept
    : device_(std::exchange(other.device_, nullptr)), mapped_(std::move(other.mapped_)) {}

V4l2Buffers::~V4l2Buffers() {
  if (!device_) return;
  // A device that is gone refuses all of it, which is as well.
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  device_->call(VIDIOC_STREAMOFF, &type);
  for (const Mapped& mapped : mapped_) ::munmap(mapped.memory, mapped.size);
  __u32 none = 0;
  request(*device_, none);
}

int V4l2Buffers::take(Filled& filled) {
  filled.buffer = blank(0);
  if (const int code = device_->call(VIDIOC_DQBUF, &filled.buffer)) return code;
  if (filled.buffer.index >= mapped_.size()) return EIO;
  const Mapped& mapped = mapped_[filled.buffer.index];
  filled.data = {static_cast<const std::uint8_t*>(mapped.memory),
                 std::min<std::size_t>(filled.buffer.bytesused, mapped.size)};
  return 0;
}

int V4l2Buffers::give_back(const Filled& filled) {
  v4l2_buffer buffer = blank(filled.buffer.index);
  return device_->call(VIDIOC_QBUF, &buffer);
}

}  // namespace ca2
