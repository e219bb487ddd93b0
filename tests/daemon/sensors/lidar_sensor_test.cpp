/// @file What a LiDAR's device tells of itself, open and closed.
#include "daemon/sensors/lidar_sensor.h"

#include <gtest/gtest.h>

#include "daemon/config/config.h"
#include "drivers/net/udp_sender.h"
#include "tests/support/private_network.h"

namespace ca2 {
namespace {

struct NoSink : InputSink {
  void picture(int, const std::string&, std::int64_t, std::shared_ptr<const Image>) override {}
  void scan(int, std::int64_t, std::shared_ptr<const Scan>) override {}
  void datagram(const std::string&, const Datagram&) override { ++datagrams; }
  int datagrams = 0;
};

TEST(LidarSensor, WhatWasLostStaysCountedWhenItIsClosedAndOpenedAgain) {
  if (!test::enter_private_network(1)) GTEST_SKIP() << "no right to make a network namespace: run as root";
  const Result<Config> config = parse_config(
      "version: 1\n"
      "board: {type: checkerboard, columns: 8, rows: 6, square: 0.04}\n"
      "cameras:\n"
      "  left: {frame: l, source: {driver: pattern}}\n"
      "lidars:\n"
      "  top: {frame: t, model: VLP-16, source: {driver: velodyne}}\n",
      "ca2d.yaml");
  ASSERT_TRUE(config) << config.error().text();
  NoSink sink;
  const auto sensors = make_lidar_sensors(config->rig, config->file, "/state", sink);
  ASSERT_EQ(sensors.size(), 1u);
  SensorDevice& top = *sensors[0];
  const auto lost = [&] { return top.health().at("top").lost; };
  EXPECT_EQ(lost(), 0u);
  const auto lose_two = [&] {
    auto sender = UdpSender::open("127.0.0.1");
    ASSERT_TRUE(sender) << sender.error().text();
    const std::vector<std::uint8_t> cut_off(100);  // no packet of a VLP-16 has that size
    sink.datagrams = 0;
    for (int i = 0; i < 2; ++i) ASSERT_TRUE(sender->send(2368, cut_off));
    for (int i = 0; i < 100 && sink.datagrams < 2; ++i) top.step();
    ASSERT_EQ(sink.datagrams, 2);
  };
  ASSERT_TRUE(top.open());
  lose_two();
  EXPECT_EQ(lost(), 2u);
  top.close();
  EXPECT_EQ(lost(), 2u);
  ASSERT_TRUE(top.open());
  EXPECT_EQ(lost(), 2u);
  lose_two();
  EXPECT_EQ(lost(), 4u);
  top.close();
}

}  // namespace
}  // namespace ca2
