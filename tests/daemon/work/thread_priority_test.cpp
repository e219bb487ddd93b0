#include "daemon/work/thread_priority.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <thread>

#include "daemon/work/job_thread.h"

namespace ca2 {
namespace {

int nice_of_this_thread() {
  return ::getpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()));
}

int nice_of(Urgency urgency) {
  Heartbeats heartbeats;
  int nice = -100;
  {
    JobThread thread("test", heartbeats, 1, std::chrono::seconds(1), urgency);
    thread.submit([&] { nice = nice_of_this_thread(); });
    while (!thread.idle()) std::this_thread::yield();
  }
  return nice;
}

TEST(ThreadPriority, WhatCanWaitGoesBehindAndTheOthersStay) {
  const int before = nice_of_this_thread();
  EXPECT_EQ(nice_of(Urgency::cannot_wait), before);
  EXPECT_EQ(nice_of(Urgency::can_wait), std::min(before + 5, 19));
  EXPECT_EQ(nice_of_this_thread(), before);
}

}  // namespace
}  // namespace ca2
