/// @file An Ouster whose rig names no metadata is asked, and its answer kept.
#include "daemon/sensors/ouster_metadata.h"

#include <gtest/gtest.h>

#include "core/io/files.h"
#include "daemon/config/config.h"
#include "tests/drivers/lidar_config/fake_ouster.h"
#include "tests/support/temporary_directory.h"

namespace ca2 {
namespace {

const std::string rig_with =
    "version: 1\n"
    "board: {type: checkerboard, columns: 8, rows: 6, square: 0.04}\n"
    "cameras:\n"
    "  left: {frame: l, source: {driver: pattern}}\n"
    "lidars:\n"
    "  top: {frame: t, ";

TEST(OusterMetadata, IsAskedForWhereTheRigNamesNone) {
  const Result<Config> asks =
      parse_config(rig_with + "source: {driver: ouster, host: 192.0.2.7}}\n", "ca2d.yaml");
  ASSERT_TRUE(asks) << asks.error().text();
  const Rig rig = with_kept_metadata(asks->rig, "/state");
  EXPECT_EQ(rig.lidars.at("top").metadata, "/state/lidars/top.json");
  EXPECT_FALSE(asks_for_metadata(rig.lidars.at("top")));
  // Without a host there is nobody to ask.
  EXPECT_FALSE(parse_config(rig_with + "source: {driver: ouster}}\n", "ca2d.yaml"));
  // A model's nominal beams are no unit's.
  const Result<Config> model =
      parse_config(rig_with + "model: OS0-128, source: {driver: ouster, host: 192.0.2.7}}\n", "ca2d.yaml");
  ASSERT_TRUE(model) << model.error().text();
  EXPECT_TRUE(asks_for_metadata(model->rig.lidars.at("top")));
  const Result<Config> velodyne =
      parse_config(rig_with + "model: VLP-16, source: {driver: velodyne, host: 192.0.2.7}}\n", "ca2d.yaml");
  ASSERT_TRUE(velodyne) << velodyne.error().text();
  EXPECT_FALSE(asks_for_metadata(velodyne->rig.lidars.at("top")));
}

TEST(OusterMetadata, IsKeptForADayWhenItDoesNotAnswer) {
  const test::TemporaryDirectory directory;
  const auto file = kept_metadata(directory.path(), "top");
  OusterConfigOptions options;
  {
    test::FakeOuster sensor;
    const test::FakeOusterHttp http(sensor, false);
    options.http.port = http.port;
    const auto fetched = fetch_metadata("127.0.0.1", file, options);
    ASSERT_TRUE(fetched) << fetched.error().text();
  }
  const std::string kept = read_text(file).value();
  EXPECT_NE(kept.find("992011000121"), std::string::npos);
  options.http.timeout = options.tcp.timeout = std::chrono::milliseconds(200);
  options.tcp.port = options.http.port;  // nobody there
  EXPECT_TRUE(fetch_metadata("127.0.0.1", file, options));
  EXPECT_EQ(read_text(file).value(), kept);
  const auto never = fetch_metadata("127.0.0.1", directory.path() / "other.json", options);
  ASSERT_FALSE(never);
  EXPECT_EQ(never.error().code, ErrorCode::unavailable);
}

}  // namespace
}  // namespace ca2
