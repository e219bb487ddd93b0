/// @file Hostile messages are told from good ones before they are decoded.
#include "messages/well_formed.h"

#include <gtest/gtest.h>

#include <ca2/command_v1_t.hpp>
#include <ca2/reply_v1_t.hpp>
#include <ca2/status_v1_t.hpp>
#include <random>
#include <vector>

namespace ca2 {
namespace {

using Bytes = std::vector<std::uint8_t>;

template <class Message>
Bytes encoded(const Message& message) {
  Bytes bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

status_v1_t status(int sensors) {
  status_v1_t message{};
  message.software = "ca2";
  message.reason = "hold still";
  message.sensor_count = sensors;
  for (int i = 0; i < sensors; ++i) {
    sensor_v1_t sensor{};
    sensor.name = "camera" + std::to_string(i);
    message.sensors.push_back(sensor);
  }
  return message;
}

command_v1_t command() {
  command_v1_t message{};
  message.sender = "pilot";
  message.command = "capture";
  message.arguments = "{}";
  return message;
}

TEST(WellFormed, LayoutsAreThoseOfTheTypes) {
  EXPECT_TRUE(well_formed(layout::command_v1, encoded(command())));
  reply_v1_t reply{};
  reply.reply = "{}";
  EXPECT_TRUE(well_formed(layout::reply_v1, encoded(reply)));
  for (const int sensors : {0, 1, 7}) EXPECT_TRUE(well_formed(layout::status_v1, encoded(status(sensors))));
}

TEST(WellFormed, ShortAndLongOnesAreRefused) {
  for (const Bytes& good : {encoded(command()), encoded(status(2))}) {
    const auto layout = good == encoded(command()) ? layout::command_v1 : layout::status_v1;
    for (std::size_t size = 0; size < good.size(); ++size) {
      EXPECT_FALSE(well_formed(layout, std::span(good).first(size)));
    }
    Bytes more = good;
    more.push_back(0);
    EXPECT_FALSE(well_formed(layout, more));
  }
}

/// Lengths that make generated decoders read beyond the message: the sender's length is at byte 16.
TEST(WellFormed, LengthsThatLieAreRefused) {
  for (const std::uint32_t length : {0u, 1u, 0x80000000u, 0xffffffffu, 0x7fffffffu, 1000u}) {
    Bytes bytes = encoded(command());
    for (int i = 0; i < 4; ++i)
      bytes[static_cast<std::size_t>(16 + i)] = static_cast<std::uint8_t>(length >> (24 - 8 * i));
    EXPECT_FALSE(well_formed(layout::command_v1, bytes)) << length;
  }
}

/// What passes can be decoded; sanitizers would tell otherwise.
TEST(WellFormed, WhatPassesDecodes) {
  std::mt19937 random(1);
  int passed = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    Bytes bytes = encoded(status(2));
    for (int change = 0; change < 3; ++change)
      bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    if (!well_formed(layout::status_v1, bytes)) continue;
    ++passed;
    status_v1_t decoded;
    decoded.decode(bytes.data(), 0, static_cast<int>(bytes.size()));
  }
  EXPECT_GT(passed, 1000);
}

}  // namespace
}  // namespace ca2
