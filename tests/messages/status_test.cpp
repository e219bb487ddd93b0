/// @file The status survives both of its forms.
#include <gtest/gtest.h>

#include <ca2/status_v1_t.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "messages/error_json.h"
#include "messages/status.h"

namespace ca2 {
namespace {

DaemonStatus example() {
  DaemonStatus status;
  status.time = 1'700'000'000'123'456'000;
  status.sequence = 42;
  status.software = "ca2 0.1.0";
  status.session = "/var/lib/ca2/sessions/a";
  status.capture.state = CaptureState::holding;
  status.capture.reason = "hold still";
  status.capture.progress = 0.25;
  status.capture.automatic = false;
  status.capture.views = 7;
  status.capture.used = 6;
  SensorStatus camera{"left", true, false, true, 15.2, 100, 3, 0.4, 1.0};
  SensorStatus lidar{"top", false, true, false, 0, 0, 0, std::nan(""), 0.015};
  status.capture.sensors = {camera, lidar};
  status.capture.last_event = "view 7 stored";
  status.capture.sigma_translation = 1.2e-3;
  status.capture.target_translation = 2e-3;
  status.capture.target_rotation = 1e-3;
  status.capture.verdict = "good";
  status.capture.next = NextPose{
      "left, 2.5 m away", "left",
      Pose::from_quaternion(Eigen::Quaterniond(0.5, 0.5, -0.5, 0.5), Eigen::Vector3d(1, 2, 3)), 1e-3, 5e-4};
  status.sensors["left"] = {"running", "", "Manta G-145B", 5, 1, 2e-4};
  status.sensors["top"] = {"retrying", "the port is in use", "", 0, 3, std::nan("")};
  status.solving = true;
  status.storage_problem = "No space left on device";
  status.recording = "/var/lib/ca2/recordings/b";
  status.recording_dropped = 9;
  status.refused_commands = 2;
  return status;
}

TEST(Status, JsonAndBack) {
  DaemonStatus status = example();
  status.capture.sensors[0].let_go = 12;
  status.store_cost = {7, 0.5, 0.7};
  const nlohmann::json json = to_json(status);
  const Result<DaemonStatus> again = status_from_json(nlohmann::json::parse(json.dump()));
  ASSERT_TRUE(again) << again.error().text();
  EXPECT_EQ(to_json(*again), json);
  EXPECT_TRUE(json.at("sensors").at(1).at("motion").is_null());
  EXPECT_TRUE(json.at("sigma_rotation").is_null());
  EXPECT_EQ(json.at("state"), "holding");
  EXPECT_EQ(again->capture.sensors[0].let_go, 12u);
  EXPECT_EQ(again->store_cost.searching, 0.7);
  EXPECT_FALSE(again->capture.sigma_rotation);
}

TEST(Status, LcmBytesAndBack) {
  const status_v1_t message = to_lcm(example());
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  ASSERT_GT(message.encode(bytes.data(), 0, static_cast<int>(bytes.size())), 0);
  status_v1_t decoded;
  ASSERT_EQ(decoded.decode(bytes.data(), 0, static_cast<int>(bytes.size())), static_cast<int>(bytes.size()));
  EXPECT_EQ(to_json(from_lcm(decoded)), to_json(example()));
}

TEST(Status, WithoutNextPoseAndWithoutAnswer) {
  DaemonStatus status = example();
  status.capture.next.reset();
  status.capture.sigma_translation.reset();
  EXPECT_EQ(to_json(from_lcm(to_lcm(status))), to_json(status));
  EXPECT_TRUE(to_json(status).at("next").is_null());
}

TEST(Status, ForeignJsonIsAnErrorWithWords) {
  for (const char* text : {"{}", "[]", "{\"time\": \"x\"}", "null"}) {
    const Result<DaemonStatus> status = status_from_json(nlohmann::json::parse(text));
    ASSERT_FALSE(status);
    EXPECT_EQ(status.error().code, ErrorCode::data);
  }
}

TEST(Status, CountsAreWholeNumbers) {
  for (const char* key : {"time", "views", "refused_commands"}) {
    nlohmann::json json = to_json(example());
    json[key] = 1e300;
    EXPECT_FALSE(status_from_json(json)) << key;
  }
}

TEST(Status, EveryStateHasItsName) {
  for (const CaptureState state : {CaptureState::waiting, CaptureState::moving, CaptureState::holding,
                                   CaptureState::capturing, CaptureState::captured, CaptureState::done}) {
    DaemonStatus status = example();
    status.capture.state = state;
    EXPECT_EQ(status_from_json(to_json(status))->capture.state, state);
    EXPECT_EQ(from_lcm(to_lcm(status)).capture.state, state);
  }
}

TEST(ErrorJson, ErrorsAndBack) {
  const Error error(ErrorCode::refused, {{"a:1:2", "wrong", "do that"}, {"", "also", ""}});
  const Error again = error_from_json(error_to_json(error));
  EXPECT_EQ(again.code, ErrorCode::refused);
  EXPECT_EQ(again.text(), error.text());
  EXPECT_EQ(error_from_json(nlohmann::json::parse("{\"code\": 1}")).code, ErrorCode::data);
  EXPECT_EQ(error_from_json(nlohmann::json::parse("[1]")).code, ErrorCode::data);
}

TEST(ErrorJson, Replies) {
  const Result<nlohmann::json> good = reply_from_json(reply_to_json(nlohmann::json{{"view", 3}}));
  ASSERT_TRUE(good);
  EXPECT_EQ(good->at("view"), 3);
  const Result<nlohmann::json> bad =
      reply_from_json(reply_to_json(fail(ErrorCode::usage, "", "no such view")));
  ASSERT_FALSE(bad);
  EXPECT_EQ(bad.error().code, ErrorCode::usage);
}

}  // namespace
}  // namespace ca2
