/// @file A V4L2 camera that exists only in this process: umockdev answers what the driver asks the kernel. It
/// cannot be streamed from (umockdev maps no memory); the guest machine's tests do that.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace ca2::test {

struct MockControl {
  std::uint32_t id = 0, type = 0;
  std::string name;
  int least = 0, most = 0, value = 0;
  int refuses = 0;  ///< errno of a write; 0: takes it
};

struct MockV4l2Device {
  int number = 0;  ///< /dev/video<number>
  std::string card = "Mock camera";
  std::uint32_t abilities = 0;  ///< device_caps
  struct Format {
    std::uint32_t fourcc = 0;
    std::vector<std::pair<int, int>> sizes;  ///< px; the first is what wrong wishes become
  };
  std::vector<Format> formats;
  double rate = 30;  ///< Hz, whatever is asked for
  std::vector<MockControl> controls;
  std::map<unsigned long, int> errors;  ///< errno by ioctl
};

/// The only V4L2 devices there are, as long as it lives.
class MockV4l2 {
 public:
  MockV4l2();
  ~MockV4l2();
  void plug_in(const MockV4l2Device& device);

  /// The controls that were written, in order, of all devices: "id=value".
  std::vector<std::pair<std::uint32_t, int>> writes() const;

  /// Does this process run under umockdev-wrapper?
  static bool possible();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace ca2::test
