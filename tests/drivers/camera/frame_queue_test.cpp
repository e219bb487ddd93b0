#include "drivers/camera/frame_queue.h"

#include <gtest/gtest.h>

#include <thread>

namespace ca2 {
namespace {

using std::chrono::milliseconds;

CameraFrame frame(std::uint64_t sequence, int stream = 0) {
  CameraFrame out;
  out.stream = stream;
  out.sequence = sequence;
  return out;
}

std::chrono::steady_clock::time_point in(milliseconds time) {
  return std::chrono::steady_clock::now() + time;
}

TEST(FrameQueue, KeepsTheNewestAndCountsTheRest) {
  FrameQueue queue(2);
  for (std::uint64_t i = 0; i < 5; ++i) queue.push(frame(i));
  EXPECT_EQ(queue.pop(in(milliseconds(0))).frame.sequence, 3u);
  EXPECT_EQ(queue.pop(in(milliseconds(0))).frame.sequence, 4u);
  EXPECT_EQ(queue.pop(in(milliseconds(1))).event, CameraEvent::timeout);
  EXPECT_EQ(queue.delivered(0), 2u);
  EXPECT_EQ(queue.overrun(0), 3u);
}

TEST(FrameQueue, CountsByImager) {
  FrameQueue queue(2);
  for (const int stream : {1, 1, 0, 1, 0}) queue.push(frame(7, stream));
  EXPECT_EQ(queue.overrun(0), 1u);
  EXPECT_EQ(queue.overrun(1), 2u);
  for (int i = 0; i < 2; ++i) queue.pop(in(milliseconds(0)));
  EXPECT_EQ(queue.delivered(0), 1u);
  EXPECT_EQ(queue.delivered(1), 1u);
}

TEST(FrameQueue, WhatCameBeforeTheLossIsDelivered) {
  FrameQueue queue(4);
  queue.push(frame(1));
  queue.lose("unplugged");
  queue.lose("silent");
  EXPECT_EQ(queue.pop(in(milliseconds(0))).event, CameraEvent::frame);
  for (int i = 0; i < 2; ++i) {
    const CameraPoll poll = queue.pop(in(milliseconds(0)));
    EXPECT_EQ(poll.event, CameraEvent::lost);
    EXPECT_EQ(poll.reason, "unplugged");
  }
  queue.restart();
  EXPECT_EQ(queue.pop(in(milliseconds(1))).event, CameraEvent::timeout);
}

TEST(FrameQueue, AnInterruptionWakesWhoWaitsAndStays) {
  FrameQueue queue(4);
  queue.push(frame(1));
  EXPECT_EQ(queue.pop(in(milliseconds(0))).event, CameraEvent::frame);
  std::thread other([&] {
    std::this_thread::sleep_for(milliseconds(20));
    queue.interrupt();
  });
  EXPECT_EQ(queue.pop(in(std::chrono::minutes(1))).event, CameraEvent::stopped);
  other.join();
  queue.push(frame(2));
  queue.restart();
  EXPECT_EQ(queue.pop(in(milliseconds(0))).event, CameraEvent::stopped);
}

}  // namespace
}  // namespace ca2
