/// @file `ca2 intrinsics` on the pictures of a session and on a folder of them.
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/io/files.h"
#include "core/io/jpeg.h"
#include "core/session/rig.h"
#include "tests/tools/ca2/small_session.h"

namespace ca2 {
namespace {

using namespace ca2::test;
namespace fs = std::filesystem;

class IntrinsicsCommand : public SmallSession {};

/// The scenario's camera: pinhole_radtan 518, 517.5, 318, 243, -0.12, 0.09, 0, 0.
void expect_true_camera(const nlohmann::json& camera) {
  const std::vector<double> truth{518, 517.5, 318, 243};
  const auto size = static_cast<std::size_t>(std::sqrt(camera["covariance"].size()));
  for (std::size_t k = 0; k < truth.size(); ++k) {
    const double sigma = std::sqrt(camera["covariance"][k * size + k].get<double>());
    EXPECT_GT(sigma, 0);
    EXPECT_LT(sigma, 1.5);
    EXPECT_NEAR(camera["parameters"][k].get<double>(), truth[k], 5 * sigma) << k;
  }
  EXPECT_LT(camera["held_out_rms_px"].get<double>(), 0.1);
}

TEST_F(IntrinsicsCommand, SessionAndFolderGiveTheTrueCamera) {
  const Outcome run = run_ca2({"intrinsics", session, "--model", "pinhole_radtan", "--json"});
  ASSERT_EQ(run.status, 0) << run.errors;
  const auto of_session = nlohmann::json::parse(run.output);
  ASSERT_EQ(of_session.size(), 1u);
  EXPECT_EQ(of_session[0]["camera"], "front");
  EXPECT_EQ(of_session[0]["model"], "pinhole_radtan");
  expect_true_camera(of_session[0]);

  fs::create_directory(folder / "pictures");
  for (int view = 1; view <= view_count; ++view) {
    const auto image = read_png(picture(view));
    ASSERT_TRUE(image);
    const fs::path file = folder / ("pictures/" + std::to_string(view));
    if (view % 2) {
      ASSERT_TRUE(write_png(file.string() + ".png", *image));
    } else {
      write_bytes(file.string() + ".JPG", *encode_jpeg(*image, 97));
    }
  }
  const Outcome alone = run_ca2({"intrinsics", folder / "pictures", "--board", session / "session.yaml",
                                 "--model", "pinhole_radtan", "--json", "--output", folder / "camera.yaml"});
  ASSERT_EQ(alone.status, 0) << alone.errors;
  const auto of_folder = nlohmann::json::parse(alone.output);
  expect_true_camera(of_folder[0]);
  const auto read = read_intrinsics(folder / "camera.yaml");
  ASSERT_TRUE(read) << read.error().text();
  EXPECT_EQ(read->parameters(0), of_folder[0]["parameters"][0].get<double>());
}

TEST_F(IntrinsicsCommand, ComparesModelsOnUnseenPictures) {
  const Outcome run = run_ca2({"intrinsics", session, "--output", folder / "k.yaml", "--format", "session"});
  ASSERT_EQ(run.status, 0) << run.errors;
  EXPECT_EQ(run.errors, "");
  for (const char* word :
       {"pinhole_radtan", "kannala_brandt", "double_sphere", "<- taken", "corners seen", "+-"}) {
    EXPECT_NE(run.output.find(word), std::string::npos) << word << "\n" << run.output;
  }
  EXPECT_NE(bytes_of(folder / "k.yaml").find("intrinsics: {model: "), std::string::npos);
}

TEST_F(IntrinsicsCommand, MistakesAndTooFewPicturesSayWhatToDo) {
  struct Case {
    std::vector<std::string> words;
    int status;
    const char* word;
  };
  fs::create_directory(folder / "empty");
  fs::create_directory(folder / "few");
  for (int view = 1; view <= 3; ++view)
    fs::copy_file(picture(view), folder / ("few/" + std::to_string(view) + ".png"));
  const std::string board = session / "session.yaml";
  const std::vector<Case> cases{
      {{folder / "nowhere"}, 74, "nowhere"},
      {{folder / "few"}, 64, "--board"},
      {{folder / "few", "--board", board}, 1, "5 are needed"},
      {{folder / "empty", "--board", board}, 65, "no PNG or JPEG"},
      {{folder / "few", "--board", folder / "none.yaml"}, 74, "none.yaml"},
      {{session, "--camera", "rear"}, 64, "front"},
      {{session, "--model", "fisheye"}, 64, "fisheye"},
      {{session, "--model", "double_sphere", "--output", folder / "k.yaml"}, 1, "double_sphere"},
  };
  for (const Case& c : cases) {
    std::vector<std::string> words{"intrinsics"};
    words.insert(words.end(), c.words.begin(), c.words.end());
    const Outcome run = run_ca2(words);
    EXPECT_EQ(run.status, c.status) << run.errors;
    EXPECT_NE(run.errors.find(c.word), std::string::npos) << run.errors;
  }
  write_bytes(folder / "few/4.png", "no picture");
  EXPECT_EQ(run_ca2({"intrinsics", folder / "few", "--board", board}).status, 65);
}

}  // namespace
}  // namespace ca2
