/// @file The event loop.
#include "daemon/loop/event_loop.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

namespace ca2 {
namespace {

using std::chrono::milliseconds;

TEST(EventLoop, RunsWhatIsPostedInOrder) {
  EventLoop loop;
  std::vector<int> order;
  std::thread other([&] {
    for (int i = 0; i < 1000; ++i) ASSERT_TRUE(loop.post([&, i] { order.push_back(i); }));
    loop.post([&] { loop.stop(); });
  });
  loop.run();
  other.join();
  ASSERT_EQ(order.size(), 1000u);
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(order[static_cast<std::size_t>(i)], i);
  EXPECT_FALSE(loop.post([] {}));
}

TEST(EventLoop, WhoIsFasterThanTheLoopIsHeldBack) {
  EventLoop loop;
  std::atomic<int> posted{0};
  std::thread other([&] {
    while (loop.post([] {})) ++posted;
  });
  // Not running yet: the queue fills up and no more.
  while (posted < 256) std::this_thread::yield();
  std::this_thread::sleep_for(milliseconds(50));
  EXPECT_EQ(posted, 256);
  EXPECT_FALSE(loop.try_post([] {}));
  loop.every(milliseconds(20), [&] { loop.stop(); });
  loop.run();
  other.join();  // the end frees who waits
  EXPECT_GT(posted, 256);
}

TEST(EventLoop, TimersComeAgainAndDoNotPileUp) {
  EventLoop loop;
  int fast = 0, slow = 0;
  loop.every(milliseconds(10), [&] { ++fast; });
  loop.every(milliseconds(100), [&] {
    std::this_thread::sleep_for(milliseconds(60));
    if (++slow == 3) loop.stop();
  });
  loop.run();
  EXPECT_EQ(slow, 3);
  EXPECT_GE(fast, 5);
  EXPECT_LE(fast, 40);
}

}  // namespace
}  // namespace ca2
