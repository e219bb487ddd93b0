/// @file check as a person runs it: one line per file on stdout, problems on stderr, the gravest status.
#include <sys/stat.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/io/files.h"
#include "drivers/lidar/model.h"
#include "drivers/lidar/ouster/metadata.h"
#include "drivers/lidar/velodyne/calibration.h"
#include "tests/tools/ca2/small_session.h"

namespace ca2 {
namespace {

using namespace ca2::test;
namespace fs = std::filesystem;

using CheckCommand = SmallSession;

TEST_F(CheckCommand, KnowsEveryKindOfFile) {
  ASSERT_EQ(solve().status, 0);
  const std::vector<std::pair<fs::path, std::string>> kinds{
      {session, "session, sound: 8 views"},
      {session / "session.yaml", "session.yaml, sound: checkerboard 8 x 5"},
      {result(), "result, sound: 1 transform by joint, 8 views"},
      {session / "truth.yaml", "truth, sound: 1 transform"},
      {picture(1), "PNG picture, sound: 640 x 480, 8 bit grey"},
      {cloud(1), "PCD cloud, sound: "},
      {fs::path(CA2_SOURCE_DIR) / "config" / "scenarios" / "paper.yaml", "scenario, sound: "},
  };
  std::vector<std::string> arguments{"check"};
  for (const auto& [file, words] : kinds) arguments.push_back(file);
  const Outcome run = run_ca2(arguments);
  EXPECT_EQ(run.status, 0);
  EXPECT_EQ(run.errors, "");
  EXPECT_EQ(std::count(run.output.begin(), run.output.end(), '\n'), static_cast<long>(kinds.size()));
  for (const auto& [file, words] : kinds) {
    EXPECT_NE(run.output.find(file.string() + ": " + words), std::string::npos) << words << "\n"
                                                                                << run.output;
  }
}

TEST_F(CheckCommand, TheGravestStatusCounts) {
  write_bytes(result(), "garbage\n");
  write_bytes(folder / "rig.yaml", "version: 1\nboard: {type: chequerboard}\n");
  write_bytes(folder / "short.png", bytes_of(picture(1)).substr(0, 500));
  const auto status = [&](const fs::path& file) { return run_ca2({"check", file}).status; };
  EXPECT_EQ(status(result()), 65);
  EXPECT_EQ(status(session), 65);
  EXPECT_EQ(status(folder / "short.png"), 65);
  EXPECT_EQ(status(folder / "nowhere.yaml"), 74);
  EXPECT_EQ(status(folder / "nowhere.png"), 74);
  EXPECT_EQ(status(session / "views"), 74);
  EXPECT_EQ(status(folder / "rig.yaml"), 78);
  EXPECT_EQ(run_ca2({"check"}).status, 64);
  const Outcome all = run_ca2({"check", "--json", folder / "short.png", folder / "rig.yaml", picture(1)});
  EXPECT_EQ(all.status, 78);
  const auto findings = nlohmann::json::parse(all.output);
  ASSERT_EQ(findings.size(), 3u);
  EXPECT_EQ(findings.at(0).at("ok"), false);
  EXPECT_EQ(findings.at(0).at("problems").at(0).at("where"), (folder / "short.png").string());
  EXPECT_GT(findings.at(1).at("problems").size(), 1u) << "all problems of a file, not the first";
  EXPECT_EQ(findings.at(2).at("ok"), true);
}

TEST_F(CheckCommand, FilesThatCameWithALidarAreKnown) {
  const OusterModel& model = *(*find_lidar_model("OS0-128"))->ouster();
  OusterMetadata metadata = nominal_ouster_metadata(model, 1024, 10, "RNG19_RFL8_SIG16_NIR16");
  const fs::path ouster = folder / "os0.json", velodyne = folder / "unit.yaml";
  write_bytes(ouster, write_ouster_metadata(metadata));
  write_bytes(velodyne, write_velodyne_yaml({std::vector<VelodyneLaser>(32)}));
  const Outcome sound = run_ca2({"check", ouster, velodyne});
  EXPECT_EQ(sound.status, 0) << sound.errors;
  EXPECT_EQ(sound.errors, "");
  EXPECT_NE(sound.output.find("os0.json: Ouster metadata, sound: "), std::string::npos) << sound.output;
  EXPECT_NE(sound.output.find("RNG19_RFL8_SIG16_NIR16, 128 beams"), std::string::npos) << sound.output;
  EXPECT_NE(sound.output.find("unit.yaml: Velodyne calibration, sound: fits VLP-32C, HDL-32E"),
            std::string::npos)
      << sound.output;
  metadata.pixel_shift.pop_back();
  write_bytes(ouster, write_ouster_metadata(metadata));
  const Outcome odd = run_ca2({"check", ouster});
  EXPECT_EQ(odd.status, 0);
  EXPECT_NE(odd.errors.find("os0.json: warning: pixel_shift_by_row"), std::string::npos) << odd.errors;
  metadata.altitude.assign(128, 0);
  write_bytes(ouster, write_ouster_metadata(metadata));
  EXPECT_EQ(run_ca2({"check", ouster}).status, 65);
}

TEST_F(CheckCommand, ASessionWithoutViewsIsSoundWithAWarning) {
  fs::remove_all(session / "views");
  const Outcome run = run_ca2({"check", session});
  EXPECT_EQ(run.status, 0);
  EXPECT_NE(run.errors.find("views: warning: there are no views yet"), std::string::npos) << run.errors;
}

TEST_F(CheckCommand, APipeThatNobodyWritesToIsToldAndNotWaitedFor) {
  for (const char* name : {"pipe.yaml", "pipe.png", "pipe.pcd"}) {
    ASSERT_EQ(::mkfifo((folder / name).c_str(), 0600), 0);
    const Outcome run = run_ca2({"check", folder / name});
    EXPECT_EQ(run.status, 74);
    EXPECT_NE(run.errors.find("is a pipe that nobody writes to"), std::string::npos) << run.errors;
  }
  EXPECT_EQ(run_ca2({"decode", folder / "pipe.yaml", "--model", "VLP-16", "--output", folder / "out"}).status,
            65);
}

TEST_F(CheckCommand, AModelThatIsNotKnownIsDoubtedByCheckAndSolve) {
  edit_rig("VLP-16", "VLP-61");
  const std::string words =
      "session.yaml: warning: puck: unknown LiDAR model 'VLP-61'; known models: OS0-32, ";
  for (const fs::path& what : {session, session / "session.yaml"}) {
    const Outcome check = run_ca2({"check", what});
    EXPECT_EQ(check.status, 0) << "others' LiDARs may be calibrated, too";
    EXPECT_NE(check.errors.find(words), std::string::npos) << check.errors;
  }
  EXPECT_NE(solve().errors.find(words), std::string::npos);
}

TEST_F(CheckCommand, ADistortionThatIsNoLenssIsDoubted) {
  edit_rig("-0.12", "500");
  const Outcome rig = run_ca2({"check", session / "session.yaml"});
  EXPECT_EQ(rig.status, 0) << rig.errors;
  EXPECT_NE(rig.errors.find("session.yaml: warning: front: the distortion draws what is "), std::string::npos)
      << rig.errors;
  EXPECT_NE(rig.errors.find("(k1 = 500); are these the coefficients of a pinhole_radtan"), std::string::npos)
      << rig.errors;
  write_bytes(folder / "fisheye.yaml",
              "distortion_model: fisheye\nwidth: 640\nheight: 480\nD: [-5, 0, 0, 0]\n"
              "K: [518, 0, 318, 0, 518, 243, 0, 0, 1]\n");
  const Outcome lens = run_ca2({"check", folder / "fisheye.yaml"});
  EXPECT_EQ(lens.status, 0) << lens.errors;
  EXPECT_NE(lens.errors.find("fisheye.yaml: warning: the distortion folds back 15 degrees"),
            std::string::npos)
      << lens.errors;
}

TEST_F(CheckCommand, ARecordingIsJudgedByWhatReplayingItReads) {
  const fs::path recording = folder / "recording";
  const fs::path pictures = recording / "cameras" / "front";
  fs::create_directories(pictures);
  fs::copy_file(picture(1), pictures / "1700000000000000000.png");
  // As recordings are written: `software` and `start` behind the rig.
  const std::string rig = bytes_of(session / "session.yaml");
  ASSERT_NE(rig.find("software: "), std::string::npos);
  write_bytes(recording / "recording.yaml", rig + "start: 1700000000000000000\n");
  for (const fs::path& what : {recording, recording / "recording.yaml"}) {
    const Outcome sound = run_ca2({"check", what});
    EXPECT_EQ(sound.status, 0) << sound.errors;
    EXPECT_NE(sound.output.find(": recording, sound: "), std::string::npos) << sound.output;
  }
  const Outcome quiet = run_ca2({"check", recording});
  EXPECT_NE(quiet.errors.find("lidars/puck.pcap: warning: cannot be opened"), std::string::npos)
      << quiet.errors;
  EXPECT_NE(quiet.output.find("1 picture;"), std::string::npos) << quiet.output;
  write_bytes(recording / "recording.yaml", rig);
  EXPECT_EQ(run_ca2({"check", recording / "recording.yaml"}).status, 78) << "without its start";
  write_bytes(recording / "recording.yaml", rig + "start: 1700000000000000000\n");
  fs::remove_all(pictures);
  EXPECT_EQ(run_ca2({"check", recording}).status, 65) << "nothing in it";
}

}  // namespace
}  // namespace ca2
