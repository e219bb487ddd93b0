/// @file Threads that do jobs, and their signs of life.
#include "daemon/work/job_thread.h"

#include <gtest/gtest.h>

#include <future>

namespace ca2 {
namespace {

using std::chrono::seconds;

TEST(JobThread, InOrderAndNotMoreThanMayWait) {
  Heartbeats heartbeats;
  JobThread thread("test", heartbeats, 2, seconds(10));
  std::promise<void> gate, started;
  std::shared_future<void> open = gate.get_future().share();
  std::vector<int> done;
  ASSERT_TRUE(thread.submit([&] {
    started.set_value();
    open.wait();
    done.push_back(0);
  }));
  started.get_future().wait();
  EXPECT_TRUE(thread.submit([&] { done.push_back(1); }));
  EXPECT_TRUE(thread.submit([&] { done.push_back(2); }));
  EXPECT_FALSE(thread.submit([&] { done.push_back(3); }));
  EXPECT_FALSE(thread.idle());
  std::promise<void> last;
  gate.set_value();
  while (!thread.submit([&] { last.set_value(); })) std::this_thread::yield();
  last.get_future().wait();
  EXPECT_EQ(done, (std::vector<int>{0, 1, 2}));
}

TEST(JobThread, TheNewestReplacesWhatWaits) {
  Heartbeats heartbeats;
  JobThread thread("test", heartbeats, 1, seconds(10));
  std::promise<void> gate, started, last;
  thread.submit([&] {
    started.set_value();
    gate.get_future().wait();
  });
  started.get_future().wait();
  int done = 0;
  thread.replace([&](const std::stop_token&) { done += 1; });
  thread.replace([&](const std::stop_token&) { done += 10; });
  thread.replace([&](const std::stop_token&) {
    done += 100;
    last.set_value();
  });
  gate.set_value();
  last.get_future().wait();
  EXPECT_EQ(done, 100);
}

/// Does what a long job should: it ends once it is asked to.
JobThread::StoppableJob until_stopped(std::promise<void>& started, bool& ended) {
  return [&](const std::stop_token& stop) {
    started.set_value();
    while (!stop.stop_requested()) std::this_thread::yield();
    ended = true;
  };
}

TEST(JobThread, ANewerOneAndTheEndStopTheJobUnderWay) {
  Heartbeats heartbeats;
  bool first = false, second = false;
  {
    JobThread thread("test", heartbeats, 1, seconds(10));
    std::promise<void> started, next;
    thread.replace(until_stopped(started, first));
    started.get_future().wait();
    thread.replace(until_stopped(next, second));
    next.get_future().wait();
    EXPECT_TRUE(first);
    EXPECT_FALSE(second);
  }
  EXPECT_TRUE(second);
}

TEST(Heartbeats, ALateThreadIsNamedAndOneThatEndedIsForgotten) {
  Heartbeats heartbeats;
  auto first = heartbeats.add("first"), second = heartbeats.add("second");
  EXPECT_FALSE(heartbeats.late());  // nothing was promised yet
  first->beat(seconds(100));
  second->beat(std::chrono::milliseconds(-1));
  EXPECT_EQ(heartbeats.late(), "second");
  second->beat(seconds(100));
  EXPECT_FALSE(heartbeats.late());
  second->beat(std::chrono::milliseconds(-1));
  second.reset();
  EXPECT_FALSE(heartbeats.late());
}

TEST(Heartbeats, AStuckJobIsNoticed) {
  Heartbeats heartbeats;
  JobThread thread("solver", heartbeats, 1, seconds(0));
  std::promise<void> gate, started;
  thread.submit([&] {
    started.set_value();
    gate.get_future().wait();
  });
  started.get_future().wait();
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_EQ(heartbeats.late(), "solver");
  gate.set_value();
  while (!thread.idle()) std::this_thread::yield();
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_FALSE(heartbeats.late());
}

}  // namespace
}  // namespace ca2
