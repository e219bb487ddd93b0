#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/robot_message_seeds.h"
#include "tools/ca2/robot_messages.h"

std::vector<std::string> ca2::fuzz::seeds() {
  return robot_message_seeds();
}

/// Whatever a log has, what is read of it is whole.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace ca2;
  using fuzz::require;
  // Memory of its own, so that a byte read past the end is seen.
  const std::vector<std::uint8_t> bytes(data, data + size);
  (void)message_utime(bytes);
  const auto image = decode_picture_message(bytes, "input");
  const auto scan = decode_cloud_message(bytes, "input");
  require(!image || kind_of_message(bytes) == RobotMessage::picture, "a picture of another message");
  require(!scan || kind_of_message(bytes) == RobotMessage::cloud, "a cloud of another message");
  if (image) {
    require(image->bytes.size() == static_cast<std::size_t>(image->width) *
                                       static_cast<std::size_t>(image->height) * image->bytes_per_pixel(),
            "half a picture");
  }
  if (scan) {
    require(scan->ring.empty() || scan->ring.size() == scan->size(), "rings");
    require(scan->intensity.empty() || scan->intensity.size() == scan->size(), "intensities");
  }
  return 0;
}
