/// A calibration that is asked to stop gives up, wherever it is, and says so.
#include <chrono>
#include <cstdio>
#include <stop_token>
#include <thread>

#include "tests/tools/solve/trials.h"

namespace ca2 {
namespace {

TEST(Cancel, AStoppedCalibrationSaysSo) {
  const Scenario scenario = load("paper", 4001).scenario;
  const Rig rig = rig_of(scenario);
  const auto sights = sights_of(rig, pool_of(scenario, 10));
  ASSERT_TRUE(sights);
  for (const Method method : {Method::joint, Method::plane_to_plane, Method::kim}) {
    std::stop_source source;
    source.request_stop();
    CalibrateOptions options;
    options.method = method;
    options.stop = source.get_token();
    const auto answer = calibrate(rig, *sights, options);
    ASSERT_FALSE(answer);
    EXPECT_EQ(answer.error().code, ErrorCode::unavailable);
    EXPECT_NE(answer.error().text().find("stopped"), std::string::npos);
  }
}

/// Asked at any time: the whole answer, or none.
TEST(Cancel, AtAnyTimeTheWholeAnswerOrNone) {
  const Scenario scenario = load("paper", 4002).scenario;
  const Rig rig = rig_of(scenario);
  const auto sights = sights_of(rig, pool_of(scenario, 60));
  ASSERT_TRUE(sights);
  const auto whole = calibrate(rig, *sights, {});
  ASSERT_TRUE(whole);
  int stopped = 0;
  double slowest = 0;
  for (int i = 0; i < 40; ++i) {
    std::stop_source source;
    std::chrono::steady_clock::time_point asked;
    const std::jthread other([&] {
      std::this_thread::sleep_for(std::chrono::microseconds(400 * i));
      asked = std::chrono::steady_clock::now();
      source.request_stop();
    });
    CalibrateOptions options;
    options.stop = source.get_token();
    const auto answer = calibrate(rig, *sights, options);
    if (answer) {
      EXPECT_EQ(answer->transforms[0].T_parent_child.t, whole->transforms[0].T_parent_child.t);
      continue;
    }
    EXPECT_EQ(answer.error().code, ErrorCode::unavailable);
    ++stopped;
    const std::chrono::duration<double> late = std::chrono::steady_clock::now() - asked;
    slowest = std::max(slowest, late.count());
  }
  EXPECT_GT(stopped, 0);
  std::printf("%d of 40 stopped, the slowest after %.2f ms\n", stopped, 1e3 * slowest);
}

}  // namespace
}  // namespace ca2
