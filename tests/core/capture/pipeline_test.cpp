#include "core/capture/pipeline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/core/capture/script.h"

namespace ca2 {
namespace {

using test::board_at;
using test::Poses;
using test::Script;

bool said(const Script& script, const std::string& kind, const std::string& words) {
  return std::any_of(script.events.begin(), script.events.end(), [&](const CaptureEvent& event) {
    return event.kind == kind && event.text.find(words) != std::string::npos;
  });
}

TEST(Pipeline, CapturesEveryHoldOnceAndNothingBetween) {
  Script script;
  Poses poses;
  poses.hold(board_at(0, 0, 1.5), 1.0)
      .hold(board_at(0.1, 0, 1.4, 0.4), 0.8)
      .hold(board_at(-0.1, 0.05, 1.6, 0.4, 2), 3.0);
  script.T_camera_board = [&](double t) { return poses.at(t); };
  CapturePipeline pipeline(script.rig, {}, {});
  script.run(pipeline, -1, poses.end() + 1);
  ASSERT_EQ(script.stored.size(), 3u);
  const double begins[] = {0, 1.5, 2.8};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_GT(script.stored[i].time, begins[i]);
    EXPECT_LT(script.stored[i].time, begins[i] + 1.0);
    EXPECT_EQ(script.stored[i].view.id, static_cast<int>(i) + 1);
    // Averaged: 16 bits; all scans of the hold.
    EXPECT_EQ(script.stored[i].view.images.at("left").bits, 16);
    EXPECT_GE(script.stored[i].view.scans.at("top").size(), 5u);
  }
  ASSERT_EQ(script.solves.size(), 1u);  // from three views on
  EXPECT_EQ(script.solves[0].views->size(), 3u);
}

TEST(Pipeline, OneViewIsSolvedForWhoAsksWhereTheOutlineIsKnown) {
  for (const bool outline : {true, false}) {
    Script script;
    if (!outline) script.rig.board.outline.reset();
    Poses poses;
    poses.hold(board_at(0, 0, 1.5), 1.5);
    script.T_camera_board = [&](double t) { return poses.at(t); };
    CapturePipeline pipeline(script.rig, {}, {});
    EXPECT_FALSE(std::holds_alternative<SolveViews>(pipeline.solve(0).front()));
    script.run(pipeline, 0, poses.end() + 1);
    ASSERT_EQ(script.stored.size(), 1u);
    EXPECT_TRUE(script.solves.empty());
    const CaptureActions asked = pipeline.solve(static_cast<std::int64_t>(test::second) * 5);
    ASSERT_EQ(asked.size(), 1u);
    EXPECT_EQ(std::holds_alternative<SolveViews>(asked.front()), outline);
  }
}

TEST(Pipeline, NothingWhileTheBoardMoves) {
  Script script;
  script.T_camera_board = [](double t) {
    return board_at(0.15 * std::sin(t), 0, 1.5, 0.2 * std::sin(0.7 * t));
  };
  CapturePipeline pipeline(script.rig, {}, {});
  script.run(pipeline, 0, 20);
  for (const Script::Stored& stored : script.stored) {
    const double speed = 0.15 * std::abs(std::cos(stored.time));
    ADD_FAILURE() << "captured at " << speed << " m/s";
  }
  EXPECT_EQ(pipeline.status(20 * test::second).state, CaptureState::moving);
}

TEST(Pipeline, TrembleOfHandsIsStill) {
  Script script;
  script.T_camera_board = [](double t) {
    return std::optional(board_at(0.0008 * std::sin(55 * t), 0.0008 * std::sin(61 * t + 1), 1.5, 0.3));
  };
  CapturePipeline pipeline(script.rig, {}, {});
  script.run(pipeline, 0, 3);
  EXPECT_EQ(script.stored.size(), 1u);
}

TEST(Pipeline, APoseThatIsKnownTeachesNothing) {
  Script script;
  Poses poses;
  poses.hold(board_at(0, 0, 1.5), 1.0)
      .hold(board_at(0.3, 0, 1.4, 0.5), 1.0)
      .hold(board_at(0.01, 0, 1.5, 0.03), 2.5);
  script.T_camera_board = [&](double t) { return poses.at(t); };
  CapturePipeline pipeline(script.rig, {}, {});
  const double asked = poses.end() - 1;
  script.run(pipeline, 0, asked);
  EXPECT_EQ(script.stored.size(), 2u);
  EXPECT_TRUE(said(script, "rejected", "view 1 shows this pose already"));
  // A person may want it all the same.
  script.handle(pipeline, asked, pipeline.capture(std::llround(1e9 * asked), false));
  script.run(pipeline, asked + 1e-3, poses.end());
  EXPECT_EQ(script.stored.size(), 3u);
}

TEST(Pipeline, AHoldThatIsSeenInPiecesIsRefusedWithoutWords) {
  Script script;
  script.T_camera_board = [](double) { return std::optional(board_at(0, 0, 1.5, 0.3)); };
  // A busy machine: every second and a half nothing comes for a while.
  script.camera_lost = [](double t) { return std::fmod(t, 1.5) > 1.0; };
  CapturePipeline pipeline(script.rig, {}, {});
  script.run(pipeline, 0, 9);
  EXPECT_EQ(script.stored.size(), 1u);
  EXPECT_FALSE(said(script, "rejected", "view 1 shows this pose already"));
}

TEST(Pipeline, ResumesASessionWithItsViews) {
  Script script;
  script.T_camera_board = [](double) { return board_at(0, 0, 1.5); };
  std::vector<ViewSights> views;
  {
    CapturePipeline pipeline(script.rig, {}, {});
    script.run(pipeline, 0, 2);
    ASSERT_EQ(script.stored.size(), 1u);
    views.push_back(*script.store(script.stored[0].view));
    views.back().id = 7;
  }
  CapturePipeline pipeline(script.rig, {}, views);
  script.run(pipeline, 0, 2);
  EXPECT_EQ(script.stored.size(), 1u);  // it has this one
  script.T_camera_board = [](double) { return board_at(0.2, 0, 1.3, 0.4); };
  script.run(pipeline, 3, 5);
  ASSERT_EQ(script.stored.size(), 2u);
  EXPECT_EQ(script.stored[1].view.id, 8);
}

TEST(Pipeline, FurnitureIsNotTheBoard) {
  Script script;
  const Pose shelf = board_at(2, 1, 0.3);
  script.others = [&](double) { return std::vector<Pose>{shelf}; };
  bool hidden = true;  // from the LiDAR
  script.T_camera_board = [&](double) { return std::optional(board_at(0, 0, 1.5)); };
  CapturePipeline pipeline(script.rig, {}, {});
  // The camera sees the board, the LiDAR only the shelf.
  for (int i = 0; i < 30; ++i) {
    const double t = i / 15.0;
    script.handle(pipeline, t, pipeline.add(script.see(t)));
    LidarObservation scan = script.scan(t);
    if (hidden) scan.sights.erase(scan.sights.begin()), scan.novelty.erase(scan.novelty.begin());
    script.handle(pipeline, t, pipeline.add(scan));
  }
  EXPECT_TRUE(script.stored.empty());
  EXPECT_TRUE(said(script, "rejected", "not there before"));
}

TEST(Pipeline, AnExtrinsicThatIsKnownTellsWrongObjects) {
  Script script;
  script.rig.extrinsics.push_back({"left", "top", script.T_camera_lidar, true});
  script.T_camera_board = [&](double) { return std::optional(board_at(0, 0, 1.5)); };
  CapturePipeline pipeline(script.rig, {}, {});
  for (int i = 0; i < 30; ++i) {
    const double t = i / 15.0;
    script.handle(pipeline, t, pipeline.add(script.see(t)));
    LidarObservation scan = script.scan(t);
    scan.sights[0].center += Eigen::Vector3d(0, 0.5, 0);  // somebody's folder, new to the room too
    script.handle(pipeline, t, pipeline.add(scan));
  }
  EXPECT_TRUE(script.stored.empty());
  EXPECT_TRUE(said(script, "rejected", "from where the cameras see it"));
}

TEST(Pipeline, ClockOffsetsAndLostFramesDoNotMatter) {
  for (const double offset : {-0.012, 0.0, 0.012}) {
    Script script;
    script.lidar_offset = offset;
    script.camera_lost = [](double t) { return static_cast<int>(std::lround(t * 15)) % 4 == 1; };
    script.lidar_lost = [](double t) { return static_cast<int>(std::lround(t * 10)) % 9 == 3; };
    Poses poses;
    for (int i = 0; i < 8; ++i) poses.hold(board_at(0.05 * (i % 3), 0, 1.4 + 0.05 * i, 0.4, i), 0.9);
    script.T_camera_board = [&](double t) { return poses.at(t); };
    CapturePipeline pipeline(script.rig, {}, {});
    script.run(pipeline, 0, poses.end());
    EXPECT_EQ(script.stored.size(), 8u) << offset;
  }
}

TEST(Pipeline, ASensorThatStopsIsLeftOut) {
  Script script;
  script.rig.lidars["aside"] = {};  // sorts before "top"; never says anything
  Poses poses;
  poses.hold(board_at(0, 0, 1.5), 1.0);
  script.T_camera_board = [&](double t) { return poses.at(t); };
  CapturePipeline pipeline(script.rig, {}, {});
  script.store = [](const StoreView& view) {
    ViewSights sights;
    sights.id = view.id;
    return Result<ViewSights>(sights);
  };
  for (int i = 0; i < 15; ++i) {
    const double t = i / 15.0;
    script.handle(pipeline, t, pipeline.add(script.see(t)));
    LidarObservation scan = script.scan(t);
    scan.lidar = 1;
    script.handle(pipeline, t, pipeline.add(scan));
  }
  ASSERT_EQ(script.stored.size(), 1u);
  EXPECT_TRUE(script.stored[0].view.scans.contains("top"));
  EXPECT_FALSE(script.stored[0].view.scans.contains("aside"));
  const CaptureStatus status = pipeline.status(test::second);
  EXPECT_TRUE(status.sensors[1].silent);
  EXPECT_FALSE(status.sensors[2].silent);
  EXPECT_NEAR(status.sensors[0].rate, 15, 0.5);
}

TEST(Pipeline, WithoutALidarThereIsNoViewAndAReason) {
  Script script;
  script.T_camera_board = [](double) { return board_at(0, 0, 1.5); };
  script.lidar_lost = [](double) { return true; };
  CapturePipeline pipeline(script.rig, {}, {});
  script.run(pipeline, 0, 2);
  EXPECT_TRUE(script.stored.empty());
  EXPECT_TRUE(said(script, "rejected", "no scans of top"));
  EXPECT_EQ(std::count_if(script.events.begin(), script.events.end(),
                          [](const CaptureEvent& event) { return event.kind == "rejected"; }),
            1);
}

TEST(Pipeline, GatesGiveTheirReasons) {
  Script script;
  script.T_camera_board = [](double) { return board_at(0, 0, 8); };
  CapturePipeline pipeline(script.rig, {}, {});
  script.run(pipeline, 0, 2);
  EXPECT_TRUE(said(script, "rejected", "too far from left"));
  Script blurred;
  blurred.corner_sigma = 0.4;
  blurred.T_camera_board = [](double) { return board_at(0, 0, 0.8); };
  CapturePipeline second(blurred.rig, {}, {});
  blurred.run(second, 0, 2);
  EXPECT_TRUE(said(blurred, "rejected", "is blurred"));
  Script oblique;
  oblique.T_camera_board = [](double) { return board_at(0, 0, 0.8, 1.3); };
  CapturePipeline third(oblique.rig, {}, {});
  oblique.run(third, 0, 2);
  EXPECT_TRUE(said(oblique, "rejected", "too obliquely"));
  EXPECT_TRUE(script.stored.empty() && blurred.stored.empty() && oblique.stored.empty());
}

TEST(Pipeline, AScanInWhichTheFinderMissedTheBoardDoesNotHarm) {
  Script script;
  script.T_camera_board = [](double) { return board_at(0, 0, 1.5); };
  CapturePipeline pipeline(script.rig, {}, {});
  for (int i = 0; i < 30; ++i) {
    const double t = i / 15.0;
    script.handle(pipeline, t, pipeline.add(script.see(t)));
    LidarObservation scan = script.scan(t);
    if (i % 4 == 2) scan.sights.clear(), scan.novelty.clear();
    script.handle(pipeline, t, pipeline.add(scan));
  }
  EXPECT_EQ(script.stored.size(), 1u);
}

TEST(Pipeline, GoesOnWhenTheClockIsSet) {
  for (const double jump : {-3600.0, 3600.0}) {
    Script script;
    script.T_camera_board = [](double) { return board_at(0, 0, 1.5); };
    CapturePipeline pipeline(script.rig, {}, {});
    script.run(pipeline, 4500, 4502);
    ASSERT_EQ(script.stored.size(), 1u);
    script.T_camera_board = [](double) { return board_at(0.1, 0, 1.3, 0.5, 2); };
    script.run(pipeline, 4502 + jump, 4504 + jump);
    EXPECT_EQ(script.stored.size(), 2u) << jump;
    for (const SensorStatus& sensor : pipeline.status(std::llround(1e9 * (4504 + jump))).sensors)
      EXPECT_FALSE(sensor.silent) << sensor.name;
  }
}

TEST(Pipeline, ALongDwellIsPossible) {
  Script script;
  script.T_camera_board = [](double) { return board_at(0, 0, 1.5); };
  CaptureOptions options;
  options.dwell = 4;
  CapturePipeline pipeline(script.rig, options, {});
  script.run(pipeline, 0, 3.5);
  EXPECT_TRUE(script.stored.empty());
  EXPECT_NEAR(pipeline.status(7 * test::second / 2).progress, 3.5 / 4, 0.05);
  script.run(pipeline, 3.6, 6);
  ASSERT_EQ(script.stored.size(), 1u);
  EXPECT_GE(script.stored[0].view.scans.at("top").size(), 28u);
}

TEST(Pipeline, ASlowCameraNeedsALongerHold) {
  for (const double rate : {1.0, 2.0, 3.0}) {
    Script script;
    script.camera_rate = rate;
    Poses poses;
    poses
        .hold(board_at(0, 0, 1.5), 1.6 / rate)  // two pictures at most
        .hold(board_at(0.3, 0, 1.4, 0.5), 4.2 / rate)
        .hold(board_at(-0.3, 0, 1.4, 0.5, 2), 4.2 / rate);
    script.T_camera_board = [&](double t) { return poses.at(t); };
    CapturePipeline pipeline(script.rig, {}, {});
    script.run(pipeline, -4, poses.end() + 1 / rate);
    ASSERT_EQ(script.stored.size(), 2u) << rate << " Hz";
    EXPECT_GT(script.stored[0].time, 1.6 / rate + 0.5) << rate << " Hz";
    for (const Script::Stored& stored : script.stored) {
      EXPECT_EQ(stored.view.images.at("left").bits, 16) << "a mean, at " << rate << " Hz";
    }
  }
}

TEST(Pipeline, ASlowCameraSaysHowLongToHold) {
  Script script;
  script.camera_rate = 1;
  script.T_camera_board = [](double) { return board_at(0, 0, 1.5); };
  CapturePipeline pipeline(script.rig, {}, {});
  script.run(pipeline, 0, 3.5);
  script.T_camera_board = [](double) { return board_at(0.2, 0, 1.5, 0.4); };
  script.run(pipeline, 4, 5.2);
  const CaptureStatus status = pipeline.status(std::llround(5.3e9));
  EXPECT_EQ(status.state, CaptureState::holding);
  EXPECT_EQ(status.reason, "hold it still for 3.0 s: left gives only 1.0 pictures a second");
  EXPECT_NEAR(status.progress, 2.0 / 3, 0.01);
}

TEST(Pipeline, MotionBetweenASlowCamerasPicturesIsSeen) {
  Script script;
  script.camera_rate = 1;
  script.T_camera_board = [](double t) { return board_at(0.05 * t, 0, 1.5); };
  CapturePipeline pipeline(script.rig, {}, {});
  script.run(pipeline, -2, 5.2);
  EXPECT_TRUE(script.stored.empty());
  const CaptureStatus status = pipeline.status(std::llround(5.3e9));
  EXPECT_EQ(status.state, CaptureState::moving);
  EXPECT_NE(status.reason.find("the board moves"), std::string::npos) << status.reason;
}

TEST(Pipeline, ACameraThatIsTooSlowSaysSo) {
  Script script;
  script.camera_rate = 0.5;
  script.T_camera_board = [](double) { return board_at(0, 0, 1.5); };
  CapturePipeline pipeline(script.rig, {}, {});
  script.run(pipeline, 0, 12.5);
  EXPECT_TRUE(script.stored.empty());
  const CaptureStatus status = pipeline.status(std::llround(12.6e9));
  EXPECT_NE(status.reason.find("left gives a picture only every 2.0 s"), std::string::npos) << status.reason;
}

TEST(Pipeline, ManualTrigger) {
  Script script;
  script.T_camera_board = [](double t) { return board_at(0.1 * t, 0, 1.5); };
  CaptureOptions options;
  options.automatic = false;
  CapturePipeline pipeline(script.rig, options, {});
  script.run(pipeline, 0, 1.5);
  EXPECT_TRUE(script.stored.empty());
  script.handle(pipeline, 1.5, pipeline.capture(3 * test::second / 2, true));  // as it is
  ASSERT_EQ(script.stored.size(), 1u);
  EXPECT_NE(script.stored[0].view.details.find("trigger: manual"), std::string::npos);
  script.handle(pipeline, 1.5, pipeline.capture(3 * test::second / 2, false));  // when it is still
  script.run(pipeline, 1.5, 2.5);
  EXPECT_EQ(script.stored.size(), 1u);
  script.T_camera_board = [](double) { return board_at(0, 0, 1.5, 0.3); };
  script.run(pipeline, 2.5, 4);
  EXPECT_EQ(script.stored.size(), 2u);
  script.run(pipeline, 4, 6);
  EXPECT_EQ(script.stored.size(), 2u);  // once
}

TEST(Pipeline, WhoAsksForAnotherViewOfAHoldGetsTheDwellThatFollows) {
  Script script;
  script.T_camera_board = [](double) { return board_at(0, 0, 1.5, 0.3); };
  CapturePipeline pipeline(script.rig, {}, {});
  script.run(pipeline, -1, 4);
  ASSERT_EQ(script.stored.size(), 1u);
  script.handle(pipeline, 4, pipeline.capture(4 * test::second, false));
  EXPECT_EQ(script.stored.size(), 1u);
  EXPECT_EQ(pipeline.status(4 * test::second).state, CaptureState::holding);
  script.run(pipeline, 4.01, 5);
  ASSERT_EQ(script.stored.size(), 2u);
  EXPECT_GE(script.stored[1].time, 4.6);
  EXPECT_EQ(script.stored[1].view.images.at("left").bits, 16) << "a mean";
  EXPECT_GE(script.stored[1].view.scans.at("top").size(), 5u);
  script.handle(pipeline, 5, pipeline.capture(5 * test::second, true));
  ASSERT_EQ(script.stored.size(), 3u);
  EXPECT_GE(script.stored[2].view.scans.at("top").size(), 1u);
}

TEST(Pipeline, AViewThatIsNotStoredDoesNotCount) {
  Script script;
  script.T_camera_board = [](double) { return board_at(0, 0, 1.5); };
  script.store = [](const StoreView&) -> Result<ViewSights> {
    return fail(ErrorCode::io, "views/000001", "the disk is full");
  };
  CapturePipeline pipeline(script.rig, {}, {});
  script.run(pipeline, 0, 5);
  EXPECT_EQ(script.stored.size(), 1u);  // one try per hold, not one per frame
  EXPECT_TRUE(said(script, "failed", "the disk is full"));
  const CaptureStatus status = pipeline.status(5 * test::second);
  EXPECT_EQ(status.views, 0);
  EXPECT_NE(status.reason.find("the disk is full"), std::string::npos);
}

TEST(Pipeline, AViewThatTurnsOutBlurredIsTakenBack) {
  Script script;
  script.T_camera_board = [](double) { return board_at(0, 0, 1.5); };
  const auto sharp = script.store;
  bool seen = true;
  script.store = [&](const StoreView& view) {
    Result<ViewSights> answer = sharp(view);
    for (Corner& corner : answer->cameras[0]->corners) corner.covariance.setIdentity();
    if (!seen) answer->cameras[0].reset();
    return answer;
  };
  for (const char* reason : {"is blurred", "too blurred to see"}) {
    CapturePipeline pipeline(script.rig, {}, {});
    script.run(pipeline, 0, 3);
    EXPECT_TRUE(said(script, "rejected", reason));
    EXPECT_EQ(pipeline.status(3 * test::second).views, 0);
    EXPECT_EQ(script.dropped, std::vector<int>{1});
    script.dropped.clear();
    seen = false;
  }
}

TEST(Pipeline, DropsAndSolves) {
  Script script;
  Poses poses;
  for (int i = 0; i < 4; ++i) poses.hold(board_at(0, 0, 1.5, 0.4, 1.5 * i), 1.0);
  script.T_camera_board = [&](double t) { return poses.at(t); };
  CapturePipeline pipeline(script.rig, {}, {});
  script.run(pipeline, 0, poses.end());
  ASSERT_EQ(script.solves.size(), 2u);
  script.handle(pipeline, 10, pipeline.drop(10 * test::second, 2));
  ASSERT_EQ(script.solves.size(), 3u);
  EXPECT_EQ(script.solves.back().views->size(), 3u);
  EXPECT_EQ(pipeline.status(10 * test::second).views, 3);
  script.handle(pipeline, 10, pipeline.drop(10 * test::second, 2));
  EXPECT_TRUE(said(script, "rejected", "there is no view 2"));
  // An answer to an older request is not one.
  Calibration old;
  old.transforms.emplace_back();
  script.handle(pipeline, 10, pipeline.solved(10 * test::second, script.solves[0].number, old));
  EXPECT_EQ(pipeline.calibration(), nullptr);
  script.handle(pipeline, 10, pipeline.solved(10 * test::second, script.solves.back().number, old));
  ASSERT_NE(pipeline.calibration(), nullptr);
  EXPECT_EQ(pipeline.status(20 * test::second).state, CaptureState::done);
}

}  // namespace
}  // namespace ca2
