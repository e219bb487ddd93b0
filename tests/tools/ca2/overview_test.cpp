/// @file What `ca2` says about itself.
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/support/temporary_directory.h"
#include "tests/tools/ca2/program.h"
#include "tests/tools/ca2/small_session.h"

namespace ca2 {
namespace {

using namespace ca2::test;
namespace fs = std::filesystem;

const std::vector<std::string> commands{
#define CA2_COMMAND(name, help) #name,
#include "tools/ca2/commands.def"
#undef CA2_COMMAND
};

TEST(Overview, HelpNamesEveryCommandAndEveryCommandHelps) {
  const Outcome all = run_ca2({"--help"});
  EXPECT_EQ(all.status, 0);
  EXPECT_EQ(all.errors, "");
  for (const std::string& command : commands) {
    EXPECT_NE(all.output.find("\n  " + command + " "), std::string::npos) << command << "\n" << all.output;
    const Outcome one = run_ca2({command, "--help"});
    EXPECT_EQ(one.status, 0) << command;
    EXPECT_EQ(one.errors, "") << command;
    EXPECT_NE(one.output.find("ca2 " + command), std::string::npos) << one.output;
  }
}

TEST(Overview, VersionIsOneLine) {
  const Outcome run = run_ca2({"--version"});
  EXPECT_EQ(run.status, 0);
  EXPECT_EQ(run.output.rfind("ca2 ", 0), 0u);
  EXPECT_EQ(run.output.find('\n'), run.output.size() - 1);
}

/// Of `ca2 ARGUMENTS` as a shell runs it.
int shell_status(const std::string& arguments) {
  const auto ca2 = std::filesystem::read_symlink("/proc/self/exe").replace_filename("ca2");
  return WEXITSTATUS(std::system(("'" + ca2.string() + "' " + arguments).c_str()));
}

TEST(Overview, OutputThatCannotBeWrittenIsNoSuccess) {
  const TemporaryDirectory folder;
  const fs::path errors = folder / "errors";
  EXPECT_EQ(shell_status("--version >/dev/full 2>'" + errors.string() + "'"), 74);
  EXPECT_EQ(bytes_of(errors), "ca2: standard output: writing failed; is the disk full?\n");
  EXPECT_EQ(shell_status("nonsense >/dev/full 2>&1"), 64);
}

}  // namespace
}  // namespace ca2
