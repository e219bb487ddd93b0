/// @file A camera of our own: writes pictures into a v4l2loopback device at a steady rate.
#pragma once

#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>

#include <chrono>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "drivers/net/unique_fd.h"

namespace ca2::test {

/// The same picture again and again, as long as it lives.
class LoopbackWriter {
 public:
  LoopbackWriter(const std::string& node, std::uint32_t fourcc, int width, int height, std::size_t stride,
                 std::vector<std::uint8_t> picture)
      : fd_(::open(node.c_str(), O_RDWR)), picture_(std::move(picture)) {
    v4l2_format format{};
    format.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
    format.fmt.pix.width = static_cast<__u32>(width);
    format.fmt.pix.height = static_cast<__u32>(height);
    format.fmt.pix.pixelformat = fourcc;
    format.fmt.pix.field = V4L2_FIELD_NONE;
    format.fmt.pix.bytesperline = static_cast<__u32>(stride);
    format.fmt.pix.sizeimage = static_cast<__u32>(picture_.size());
    if (::ioctl(fd_.get(), VIDIOC_S_FMT, &format) != 0)
      throw std::runtime_error("v4l2loopback refuses the format");
    // It is a camera from the first picture on.
    if (::write(fd_.get(), picture_.data(), picture_.size()) < 0)
      throw std::runtime_error("v4l2loopback refuses a picture");
    thread_ = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        if (::write(fd_.get(), picture_.data(), picture_.size()) < 0) return;
        std::this_thread::sleep_for(std::chrono::milliseconds(66));
      }
    });
  }

 private:
  UniqueFd fd_;
  std::vector<std::uint8_t> picture_;
  std::jthread thread_;  ///< last: it uses the others
};

}  // namespace ca2::test
