/// @file configure, and sensors --probe, against a sensor of the loopback.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "drivers/lidar/ouster/metadata.h"
#include "tests/drivers/lidar_config/fake_ouster.h"
#include "tests/tools/ca2/program.h"

namespace ca2 {
namespace {

using namespace ca2::test;
namespace fs = std::filesystem;

class ConfigureCommand : public testing::Test {
 protected:
  ConfigureCommand() : fake(sensor, false), host("127.0.0.1:" + std::to_string(fake.port)) {}

  std::size_t changes_made() {
    const std::lock_guard lock(sensor.mutex);
    return sensor.log.size();
  }

  FakeOuster sensor;
  FakeOusterHttp fake;
  std::string host;
};

TEST_F(ConfigureCommand, SaysWhatWouldChangeAndChangesOnlyWhenTold) {
  const std::vector<std::string> wanted{"--destination", "192.0.2.9", "--mode",
                                        "512x20",        "--set",     "udp_port_imu=7503"};
  std::vector<std::string> arguments{"configure", host};
  arguments.insert(arguments.end(), wanted.begin(), wanted.end());
  const Outcome dry = run_ca2(arguments);
  EXPECT_EQ(dry.status, 0) << dry.errors;
  EXPECT_NE(dry.output.find("udp_dest: 192.0.2.50 -> 192.0.2.9\n"), std::string::npos) << dry.output;
  EXPECT_NE(dry.output.find("lidar_mode: 1024x10 -> 512x20\n"), std::string::npos);
  EXPECT_EQ(dry.output.find("udp_port_imu"), std::string::npos) << "it is so already";
  EXPECT_NE(dry.output.find("nothing was changed"), std::string::npos);
  EXPECT_EQ(changes_made(), 0u);

  arguments.insert(arguments.end(), {"--apply", "--json"});
  const Outcome applied = run_ca2(arguments);
  ASSERT_EQ(applied.status, 0) << applied.errors;
  const json report = json::parse(applied.output);
  EXPECT_EQ(report["vendor"], "Ouster");
  EXPECT_EQ(report["applied"], true);
  EXPECT_EQ(report["changes"].size(), 2u);
  const std::size_t made = changes_made();
  EXPECT_GT(made, 0u);
  EXPECT_EQ(sensor.config["udp_dest"], "192.0.2.9");
  EXPECT_EQ(sensor.config["lidar_mode"], "512x20");

  const Outcome again = run_ca2(arguments);
  EXPECT_EQ(again.status, 0);
  EXPECT_EQ(json::parse(again.output)["applied"], false);
  EXPECT_EQ(changes_made(), made) << "a sensor that is as wanted must not restart";
}

TEST_F(ConfigureCommand, SavesTheMetadataThatDecodeTakes) {
  const fs::path file = fs::temp_directory_path() / ("ca2_metadata_" + std::to_string(::getpid()) + ".json");
  const Outcome run = run_ca2({"configure", host, "--save-metadata", file});
  EXPECT_EQ(run.status, 0) << run.errors;
  const auto metadata = read_ouster_metadata(file);
  ASSERT_TRUE(metadata) << metadata.error().text();
  EXPECT_EQ(metadata->pixels_per_column, 32);
  fs::remove(file);
}

TEST_F(ConfigureCommand, WhatCannotBeSetIsToldWithoutTouchingTheSensor) {
  const auto status = [&](std::vector<std::string> options) {
    std::vector<std::string> all{"configure", host, "--apply"};
    all.insert(all.end(), options.begin(), options.end());
    return run_ca2(all).status;
  };
  EXPECT_EQ(status({"--set", "no_such_setting=1"}), 78);
  EXPECT_EQ(status({"--mode", "3x3"}), 78) << "the sensor itself refuses";
  EXPECT_EQ(status({"--rpm", "600"}), 64) << "a Velodyne's";
  EXPECT_EQ(status({"--set", "keyonly"}), 64);
  EXPECT_EQ(changes_made(), 0u);
  EXPECT_EQ(run_ca2({"configure", host, "--persist"}).status, 64) << "without --apply";
  EXPECT_EQ(run_ca2({"configure", "127.0.0.1:1", "--mode", "512x10"}).status, 69);
}

TEST_F(ConfigureCommand, SensorsProbeAsksAnAddress) {
  const Outcome run = run_ca2({"sensors", "--probe", host, "--json"});
  ASSERT_EQ(run.status, 0) << run.errors;
  const json answer = json::parse(run.output)["probe"][host];
  EXPECT_EQ(answer["vendor"], "Ouster");
  EXPECT_EQ(answer["prod_line"], "OS-1-32");
  EXPECT_EQ(answer["build_rev"], "v3.1.0");
  EXPECT_EQ(changes_made(), 0u);
  EXPECT_EQ(run_ca2({"sensors", "--probe", "127.0.0.1:1"}).status, 69);
}

TEST(ConfigureVelodyne, OneFormPerChange) {
  FakeHttp fake;
  json config = {{"rpm", 600}, {"returns", "Strongest"}, {"host", {{"addr", "255.255.255.255"}}}};
  std::vector<std::string> posts;
  fake.server.Get("/cgi/snapshot.hdl", [&](const httplib::Request&, httplib::Response& out) {
    out.set_content(json{{"config", config}}.dump(), "application/json");
  });
  fake.server.Post("/cgi/.*", [&](const httplib::Request& in, httplib::Response&) {
    posts.push_back(in.path + " " + in.body);
    if (in.body == "rpm=1200") config["rpm"] = 1200;
    if (in.body == "addr=192.0.2.9") config["host"]["addr"] = "192.0.2.9";
  });
  fake.start();
  const std::string host = "127.0.0.1:" + std::to_string(fake.port);
  const Outcome run = run_ca2({"configure", host, "--vendor", "velodyne", "--rpm", "1200", "--destination",
                               "192.0.2.9", "--returns", "strongest", "--apply"});
  EXPECT_EQ(run.status, 0) << run.errors;
  EXPECT_EQ(posts, (std::vector<std::string>{"/cgi/setting/host addr=192.0.2.9", "/cgi/setting rpm=1200"}));
  // A sensor that says yes and does nothing.
  const Outcome refused =
      run_ca2({"configure", host, "--vendor", "velodyne", "--returns", "Dual", "--apply"});
  EXPECT_EQ(refused.status, 78);
  EXPECT_NE(refused.errors.find("returns is still Strongest, not Dual"), std::string::npos) << refused.errors;
}

}  // namespace
}  // namespace ca2
