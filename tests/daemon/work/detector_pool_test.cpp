/// @file Searching under load: nothing is held up, everything is accounted for.
#include "daemon/work/detector_pool.h"

#include <gtest/gtest.h>

#include <map>

namespace ca2 {
namespace {

Rig two_cameras() {
  Rig rig;
  rig.board.type = find_board_type("checkerboard");
  rig.board.columns = 8;
  rig.board.rows = 6;
  rig.board.square = 0.04;
  rig.cameras["a"] = rig.cameras["b"] = {};
  return rig;
}

std::shared_ptr<const Image> noise() {
  auto image = std::make_shared<Image>(Image{640, 480, 1, 8, {}});
  unsigned state = 1;
  for (int i = 0; i < 640 * 480; ++i) {
    state = state * 1664525 + 1013904223;
    image->bytes.push_back(static_cast<std::uint8_t>(state >> 24));
  }
  return image;
}

TEST(DetectorPool, EveryFrameComesOutOnceAndInOrder) {
  std::mutex mutex;
  std::map<int, std::vector<std::int64_t>> times;
  std::map<int, int> searched;
  constexpr int frames = 200;
  Heartbeats heartbeats;
  {
    ObservationSink sink;
    sink.camera = [&](const CameraObservation& observation) {
      const std::lock_guard lock(mutex);
      times[observation.camera].push_back(observation.time);
      searched[observation.camera] += observation.searched;
      EXPECT_EQ(observation.searched, observation.image != nullptr);
    };
    DetectorPool pool(two_cameras(), sink, heartbeats);
    const auto image = noise();
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; i < frames; ++i) {
      for (const int camera : {0, 1}) pool.add(camera, i, image);
    }
    // Adding never waits for a search.
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(500));
    const auto all = [&] {
      const std::lock_guard lock(mutex);
      return times[0].size() == frames && times[1].size() == frames;
    };
    for (int wait = 0; wait < 1000 && !all(); ++wait) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }
  for (const int camera : {0, 1}) {
    ASSERT_EQ(times[camera].size(), static_cast<std::size_t>(frames));
    for (int i = 0; i < frames; ++i) EXPECT_EQ(times[camera][static_cast<std::size_t>(i)], i);
    EXPECT_GE(searched[camera], 1);
    EXPECT_LT(searched[camera], frames);  // there was no time for all
  }
}

}  // namespace
}  // namespace ca2
