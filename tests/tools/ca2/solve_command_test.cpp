/// @file solve and report as a person runs them, on a simulated session.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/io/files.h"
#include "core/session/calibration.h"
#include "tests/tools/ca2/small_session.h"
#include "tools/sim/truth_file.h"

namespace ca2 {
namespace {

using namespace ca2::test;
namespace fs = std::filesystem;

class SolveCommand : public SmallSession {
 protected:
  /// How far result.yaml's one transform is from truth.yaml's: rotation (rad), translation (m).
  Vector6d error_of(const fs::path& file) const {
    const auto answer = read_calibration(file);
    const auto truth = read_true_transforms(session / "truth.yaml");
    if (!answer || !truth || answer->transforms.size() != 1 || truth->size() != 1) {
      ADD_FAILURE() << (answer ? "not one transform" : answer.error().text());
      return Vector6d::Constant(1e9);
    }
    return answer->transforms[0].T_parent_child.difference((*truth)[0].T_parent_child);
  }

  std::vector<int> used_views(const fs::path& file) const {
    std::vector<int> ids;
    const auto answer = read_calibration(file);
    if (!answer) return ids;
    for (const CalibratedView& view : answer->views) {
      if (view.used) ids.push_back(view.id);
    }
    return ids;
  }
};

TEST_F(SolveCommand, AnswersWithinItsUncertaintyAndIsQuietInAPipe) {
  const Outcome run = solve();
  ASSERT_EQ(run.status, 0) << run.errors;
  EXPECT_EQ(run.errors, "");
  EXPECT_NE(run.output.find("T_front_puck"), std::string::npos) << run.output;
  EXPECT_NE(run.output.find("verdict: good"), std::string::npos) << run.output;
  EXPECT_NE(run.output.find("true error of T_front_puck"), std::string::npos) << run.output;
  const Vector6d error = error_of(result());
  EXPECT_LT(error.tail<3>().norm(), 0.005);
  EXPECT_LT(error.head<3>().norm(), 0.002);
  const auto answer = read_calibration(result());
  EXPECT_LT(error.tail<3>().norm(), 3 * answer->transforms[0].sigma_translation());
  EXPECT_LT(answer->transforms[0].sigma_translation(), 0.005);
  EXPECT_EQ(used_views(result()).size(), 8u);
}

/// An answer that cannot be kept is shown all the same.
TEST_F(SolveCommand, AResultThatCannotBeWrittenIsPrinted) {
  const Outcome run = run_ca2({"solve", session, "--output", folder / "no" / "such" / "folder.yaml"});
  EXPECT_NE(run.status, 0);
  EXPECT_NE(run.output.find("T_front_puck"), std::string::npos) << run.output;
  EXPECT_EQ(run.output.find("written to"), std::string::npos) << run.output;
  EXPECT_NE(run.errors.find("folder.yaml"), std::string::npos) << run.errors;
  EXPECT_NE(run.errors.find("--output FILE writes the result elsewhere"), std::string::npos) << run.errors;
}

TEST_F(SolveCommand, TheResultHasItsFixedKeysAndJsonSaysTheSame) {
  const Outcome run = solve({"--json"});
  ASSERT_EQ(run.status, 0) << run.errors;
  const std::string text = bytes_of(result());
  for (const char* key : {"version: 1\n",
                          "software: \"ca2 ",
                          "method: joint\n",
                          "transforms:\n",
                          "parent: front\n",
                          "child: puck\n",
                          "parent_frame: front_camera_optical\n",
                          "child_frame: velodyne\n",
                          "translation: [",
                          "rotation: {x: ",
                          "covariance:",
                          "sigma_translation_mm: ",
                          "sigma_rotation_mrad: ",
                          "cameras:\n",
                          "model: pinhole_radtan\n",
                          "parameters: [",
                          "estimated: ",
                          "sigma: [",
                          "lidars:\n",
                          "range_bias: ",
                          "range_bias_sigma: ",
                          "range_sigma: ",
                          "observability: {verdict: good, weakest_direction: ",
                          "condition: ",
                          "validation:\n",
                          "leave_one_out: {translation_mm: ",
                          "rotation_mrad: ",
                          "outline_offset_mm: ",
                          "reprojection_rms_px: ",
                          "range_rms_mm: ",
                          "{id: 1, used: true, reason: \"\"",
                          "plane_rms_mm: "}) {
    EXPECT_NE(text.find(key), std::string::npos) << key;
  }
  const auto json = nlohmann::json::parse(run.output);
  EXPECT_EQ(json.at("version"), 1);
  EXPECT_EQ(json.at("method"), "joint");
  EXPECT_EQ(json.at("observability").at("verdict"), "good");
  const auto& transform = json.at("transforms").at(0);
  EXPECT_EQ(transform.at("parent"), "front");
  EXPECT_EQ(transform.at("covariance").size(), 36u);
  const auto answer = read_calibration(result());
  ASSERT_TRUE(answer) << answer.error().text();
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(transform.at("translation").at(k).get<double>(),
              answer->transforms[0].T_parent_child.t(static_cast<Eigen::Index>(k)));
  }
  EXPECT_EQ(json.at("views").size(), 8u);
}

TEST_F(SolveCommand, MethodsViewsAndOutputAreAsAsked) {
  for (const std::string method : {"kim", "plane_to_plane", "joint"}) {
    const fs::path file = folder / (method + ".yaml");
    const Outcome run = solve({"--method", method, "--output", file});
    ASSERT_EQ(run.status, 0) << run.errors;
    const auto answer = read_calibration(file);
    ASSERT_TRUE(answer) << answer.error().text();
    EXPECT_EQ(answer->method, method);
    EXPECT_LT(error_of(file).tail<3>().norm(), 0.02) << method;
    EXPECT_LT(error_of(file).head<3>().norm(), 0.01) << method;
  }
  EXPECT_FALSE(fs::exists(result())) << "--output is instead of result.yaml";
  const fs::path some = folder / "some.yaml";
  const Outcome run = solve({"--views", "1,3-5", "-o", some});
  ASSERT_EQ(run.status, 0) << run.errors;
  EXPECT_EQ(used_views(some), (std::vector<int>{1, 3, 4, 5}));
}

TEST_F(SolveCommand, TwoViewsOfARimAreAWeakAnswer) {
  const fs::path two = folder / "two.yaml";
  const Outcome run = solve({"--views", "1,2", "-o", two});
  ASSERT_EQ(run.status, 0) << run.errors;
  EXPECT_LT(error_of(two).tail<3>().norm(), 0.03);
  EXPECT_NE(run.output.find("verdict: weak"), std::string::npos) << run.output;
  EXPECT_NE(run.output.find("rests on the plate's rim"), std::string::npos) << run.output;
  // Planes do not determine two views: what a third one gives is no share of that.
  EXPECT_NE(run.output.find("next: "), std::string::npos) << run.output;
  EXPECT_EQ(run.output.find("expect 0.00 mm"), std::string::npos) << run.output;
}

TEST_F(SolveCommand, TheBestViewsAreNearlyAsGoodAsAll) {
  const fs::path best = folder / "best.yaml", all = folder / "all.yaml";
  const Outcome run = solve({"--best", "6", "-o", best});
  ASSERT_EQ(run.status, 0) << run.errors;
  ASSERT_EQ(solve({"-o", all}).status, 0);
  EXPECT_EQ(used_views(best).size(), 6u);
  const auto chosen = read_calibration(best), everything = read_calibration(all);
  ASSERT_TRUE(chosen && everything);
  EXPECT_EQ(chosen->views.size(), static_cast<std::size_t>(view_count));
  EXPECT_LE(chosen->transforms[0].sigma_translation(), 1.5 * everything->transforms[0].sigma_translation());
  EXPECT_NE(run.output.find("not among the best 6"), std::string::npos);
}

TEST_F(SolveCommand, HoldsWhatItIsTold) {
  const fs::path held = folder / "held.yaml", all = folder / "all.yaml";
  ASSERT_EQ(solve({"--hold", "intrinsics,ranges", "-o", held}).status, 0);
  ASSERT_EQ(solve({"-o", all}).status, 0);
  const auto believing = read_calibration(held), doubting = read_calibration(all);
  ASSERT_TRUE(believing && doubting);
  EXPECT_TRUE(std::ranges::any_of(believing->notes, [](const std::string& note) {
    return note == "taken for exactly right, as asked: given intrinsics, ranges";
  }));
  for (const auto& [name, camera] : believing->cameras) EXPECT_FALSE(camera.estimated) << name;
  for (const auto& [name, lidar] : believing->lidars) EXPECT_FALSE(lidar.estimated) << name;
  for (const auto& [name, camera] : doubting->cameras) EXPECT_TRUE(camera.estimated) << name;
  EXPECT_EQ(solve({"--hold", "beliefs"}).status, 64);
  EXPECT_EQ(solve({"--hold", "ranges", "--method", "kim"}).status, 64);
}

TEST_F(SolveCommand, TellsTheNextPoseUntilTheTargetIsReached) {
  EXPECT_EQ(solve().output.find("next: show the board"), std::string::npos);
  const Outcome few = solve({"--views", "1-3", "--method", "plane_to_plane"});
  ASSERT_EQ(few.status, 0) << few.errors;
  EXPECT_NE(few.output.find("next: show the board"), std::string::npos) << few.output;
}

TEST_F(SolveCommand, CacheAndThreadsDoNotChangeAByte) {
  ASSERT_EQ(solve().status, 0);
  const std::string first = bytes_of(result());
  ASSERT_FALSE(first.empty());
  fs::remove_all(session / "cache");
  ASSERT_EQ(solve({"--threads", "1"}).status, 0);
  EXPECT_EQ(bytes_of(result()), first);
  EXPECT_TRUE(fs::exists(session / "cache"));
  ASSERT_EQ(solve({"--threads", "2"}).status, 0);
  EXPECT_EQ(bytes_of(result()), first);
  ASSERT_EQ(solve({"--no-cache", "--threads", "2"}).status, 0);
  EXPECT_EQ(bytes_of(result()), first);
}

TEST_F(SolveCommand, ACacheWithFlippedBytesDoesNotChangeTheResult) {
  ASSERT_EQ(solve().status, 0);
  const std::string first = bytes_of(result());
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(session / "cache")) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  ASSERT_EQ(files.size(), 2u * view_count);
  std::sort(files.begin(), files.end());
  // Header, payload, end; cut short, empty, something else: every file gets one of them, in both rounds
  // another one.
  for (const std::size_t round : {0u, 3u}) {
    for (std::size_t i = 0; i < files.size(); ++i) {
      std::string text = bytes_of(files[i]);
      ASSERT_GT(text.size(), 60u) << files[i];
      switch ((i + round) % 6) {
        case 0:
          text[4 + 8 * (i % 5)] ^= 0x40;
          break;
        case 1:
          text[text.size() / 2] ^= 0x01;
          break;
        case 2:
          text.back() ^= 0x7f;
          break;
        case 3:
          text.resize(text.size() / 2);
          break;
        case 4:
          text.clear();
          break;
        default:
          text.assign(100000, '\xff');
      }
      write_bytes(files[i], text);
    }
    const Outcome run = solve();
    ASSERT_EQ(run.status, 0) << run.errors;
    EXPECT_EQ(bytes_of(result()), first);
  }
}

TEST_F(SolveCommand, ChangedDataIsSearchedAgain) {
  ASSERT_EQ(solve().status, 0);
  fs::copy_file(picture(1), picture(2), fs::copy_options::overwrite_existing);
  fs::copy_file(cloud(1), cloud(2), fs::copy_options::overwrite_existing);
  ASSERT_EQ(solve().status, 0);
  const std::string cached = bytes_of(result());
  ASSERT_EQ(solve({"--no-cache"}).status, 0);
  EXPECT_EQ(bytes_of(result()), cached);
}

TEST_F(SolveCommand, ReportIsOneFileAndAPicture) {
  ASSERT_EQ(solve().status, 0);
  const Outcome run = run_ca2({"report", session});
  ASSERT_EQ(run.status, 0) << run.errors;
  EXPECT_EQ(run.errors, "");
  const std::string page = bytes_of(session / "report" / "index.html");
  EXPECT_EQ(page.rfind("<!doctype html>", 0), 0u);
  EXPECT_NE(page.find("</html>"), std::string::npos);
  EXPECT_EQ(page.find("http"), std::string::npos) << "the page must not need a network";
  EXPECT_EQ(page.find("<script"), std::string::npos);
  EXPECT_NE(page.find("Verdict: good"), std::string::npos);
  EXPECT_NE(page.find("data:image/jpeg;base64,"), std::string::npos);
  const auto overlay = read_png(session / "report" / "overlay.png");
  ASSERT_TRUE(overlay) << overlay.error().text();
  EXPECT_EQ(overlay->width, 640);
  EXPECT_EQ(overlay->height, 480);
  EXPECT_EQ(overlay->channels, 3);
  // Grey is the picture; the points are in colour.
  int coloured = 0;
  for (std::size_t i = 0; i + 2 < overlay->bytes.size(); i += 3) {
    coloured += overlay->bytes[i] != overlay->bytes[i + 1] || overlay->bytes[i + 1] != overlay->bytes[i + 2];
  }
  EXPECT_GT(coloured, 500);
}

}  // namespace
}  // namespace ca2
