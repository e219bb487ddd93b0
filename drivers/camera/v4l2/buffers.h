/// @file Buffers shared with the kernel: a camera's pictures without a copy.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/types/result.h"
#include "drivers/camera/v4l2/device.h"

namespace ca2 {

/// Streams from its construction to its destruction. The device must outlive it.
class V4l2Buffers {
 public:
  static Result<V4l2Buffers> start(const V4l2Device& device, int wanted);
  V4l2Buffers(V4l2Buffers&& other) noexcept;
  V4l2Buffers& operator=(V4l2Buffers&&) = delete;
  ~V4l2Buffers();

  struct Filled {
    v4l2_buffer buffer{};
    std::span<const std::uint8_t> data;  ///< until the buffer is given back
  };
  /// The oldest filled one. 0, or the errno: EAGAIN when there is none.
  int take(Filled& filled);
  /// To the kernel again. 0 or the errno.
  int give_back(const Filled& filled);

 private:
  struct Mapped {
    void* memory = nullptr;
    std::size_t size = 0;
  };
  explicit V4l2Buffers(const V4l2Device& device) : device_(&device) {}
  Result<void> map(int wanted);

  const V4l2Device* device_;  ///< nullptr: moved from
  std::vector<Mapped> mapped_;
};

}  // namespace ca2
