/// @file ca2d.yaml.
#include "daemon/config/config.h"

#include <gtest/gtest.h>

namespace ca2 {
namespace {

const std::string rig =
    "version: 1\n"
    "board: {type: checkerboard, columns: 8, rows: 6, square: 0.04}\n"
    "cameras:\n"
    "  left: {frame: l, source: {driver: pattern}}\n"
    "lidars:\n"
    "  top: {frame: t, model: VLP-16, source: {driver: velodyne, port: 2368}}\n";

TEST(Config, DefaultsAndOptions) {
  const Result<Config> config =
      parse_config(rig + "capture: {dwell: 1.5, automatic: false}\npreview: {width: 320}\n", "a/ca2d.yaml");
  ASSERT_TRUE(config) << config.error().text();
  EXPECT_EQ(config->options.capture.dwell, 1.5);
  EXPECT_FALSE(config->options.capture.automatic);
  EXPECT_EQ(config->options.preview_width, 320);
  EXPECT_EQ(config->options.state_directory, "/var/lib/ca2");
  EXPECT_EQ(config->rig.cameras.size(), 1u);
}

TEST(Config, PrintedAndReadAgain) {
  const Result<Config> config =
      parse_config(rig + "capture: {dwell: 1.5}\nstate: {directory: /a b}\n", "ca2d.yaml");
  ASSERT_TRUE(config);
  const std::string text = write_config(*config);
  const Result<Config> again = parse_config(text, "ca2d.yaml");
  ASSERT_TRUE(again) << again.error().text() << text;
  EXPECT_EQ(write_config(*again), text);
  EXPECT_EQ(again->options.state_directory, "/a b");
}

TEST(Config, EveryProblemIsTold) {
  const Result<Config> config = parse_config(
      "version: 1\n"
      "board: {type: checkerboard, columns: 8, rows: 6, square: 0.04}\n"
      "cameras:\n"
      "  left: {source: {driver: patern}}\n"
      "  right: {source: {driver: pattern, rate: 1}}\n"
      "lidars:\n"
      "  top: {model: VLP-99, source: {driver: velodyne, port: 0, host: robot}}\n"
      "capture: {dwell: 100, dwel: 1}\n"
      "lcm: {url: 'tcpq://'}\n"
      "preview: 3\n",
      "ca2d.yaml");
  ASSERT_FALSE(config);
  EXPECT_EQ(config.error().code, ErrorCode::config);
  const std::string text = config.error().text();
  for (const char* expected :
       {"ca2d.yaml:8:18", "unknown key 'dwel'", "provider must be udpm", "ca2d.yaml:10:10: preview",
        "camera left", "did you mean 'pattern'", "lidar top: source", "'robot' is no numeric address",
        "'port' must be", "VLP-99"}) {
    EXPECT_NE(text.find(expected), std::string::npos) << expected << "\n" << text;
  }
}

TEST(Config, WhatOnlyARestartChanges) {
  DaemonOptions before, after;
  after.capture.dwell = 1;
  after.preview_rate = 0;
  EXPECT_TRUE(needs_restart(before, after).empty());
  after.state_directory = "/other";
  after.lcm_enabled = false;
  EXPECT_EQ(needs_restart(before, after), (std::vector<std::string>{"state.directory", "lcm.enabled"}));
}

}  // namespace
}  // namespace ca2
