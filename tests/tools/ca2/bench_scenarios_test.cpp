/// @file Where `ca2 bench` finds the scenarios that it simulates.
#include <gtest/gtest.h>

#include <cstdlib>

#include "core/io/files.h"
#include "tests/support/temporary_directory.h"
#include "tests/tools/ca2/program.h"

namespace ca2 {
namespace {

namespace fs = std::filesystem;
using namespace ca2::test;

constexpr const char* benches[] = {"solve", "accuracy", "stereo", "guidance"};

TEST(BenchScenarios, WithoutThemItSaysWhatToDoBeforeAnyTable) {
  ASSERT_FALSE(fs::exists("config/scenarios")) << "the test is to be run elsewhere";
  for (const char* bench : benches) {
    const Outcome run = run_ca2({"bench", bench});
    EXPECT_EQ(run.status, 65) << bench;
    EXPECT_EQ(run.output, "") << bench;
    EXPECT_NE(run.errors.find("--data"), std::string::npos) << run.errors;
    EXPECT_NE(run.errors.find("share/ca2/scenarios"), std::string::npos) << run.errors;
  }
}

TEST(BenchScenarios, FolderWithoutThemIsRefusedByName) {
  const TemporaryDirectory folder;
  for (const char* bench : benches) {
    const Outcome run = run_ca2({"bench", bench, "--data", folder.path().string()});
    EXPECT_EQ(run.status, 65) << bench;
    EXPECT_EQ(run.output, "") << bench;
    EXPECT_NE(run.errors.find(folder.path().string() + "/"), std::string::npos) << run.errors;
    EXPECT_EQ(run_ca2({"bench", bench, "--data", (folder.path() / "none").string()}).status, 65) << bench;
  }
}

TEST(BenchScenarios, InstalledProgramFindsThemFromAnywhere) {
  const TemporaryDirectory prefix;
  fs::create_directories(prefix.path() / "bin");
  fs::create_directories(prefix.path() / "share/ca2");
  fs::create_directories(prefix.path() / "elsewhere");
  fs::copy(fs::read_symlink("/proc/self/exe").replace_filename("ca2"), prefix.path() / "bin/ca2");
  fs::copy(CA2_SOURCE_DIR "/config/scenarios", prefix.path() / "share/ca2/scenarios",
           fs::copy_options::recursive);
  const fs::path printed = prefix.path() / "printed";
  const std::string command = "cd " + (prefix.path() / "elsewhere").string() +
                              " && ../bin/ca2 bench stereo --only manta --trials 1 >" + printed.string();
  ASSERT_EQ(std::system(command.c_str()), 0);
  const auto table = read_text(printed);
  ASSERT_TRUE(table);
  EXPECT_NE(table->find("os0_manta"), std::string::npos) << *table;
}

}  // namespace
}  // namespace ca2
