/// @file What `ca2` says about itself.
#include <gtest/gtest.h>

#include <cstdlib>
#include <iterator>
#include <sstream>

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

struct Example {
  std::string command, line;
};
const std::vector<Example> examples{
#define CA2_EXAMPLE(line, command) {command, line},
#include "tools/ca2/examples.def"
#undef CA2_EXAMPLE
};

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream stream(text);
  return {std::istream_iterator<std::string>(stream), {}};
}

/// Everything that can be run: a command, or each of those below it.
std::vector<std::string> leaves(const std::string& command) {
  std::vector<std::string> words = words_of(command);
  words.push_back("--help");
  std::istringstream help(run_ca2(words).output);
  std::vector<std::string> found;
  bool below = false;
  for (std::string line; std::getline(help, line);) {
    if (line == "Subcommands:") {
      below = true;
    } else if (line.empty()) {
      below = false;
    } else if (below) {
      found.push_back(command + " " + words_of(line).front());
    }
  }
  return found.empty() ? std::vector{command} : found;
}

TEST(Overview, EveryCommandsHelpHasExamplesOfIt) {
  for (const std::string& command : commands) {
    for (const std::string& leaf : leaves(command)) {
      std::vector<std::string> words = words_of(leaf);
      words.push_back("--help");
      EXPECT_NE(run_ca2(words).output.find("\n  ca2 " + leaf), std::string::npos) << leaf;
    }
  }
}

class Examples : public SmallSession {
 protected:
  int run(const std::string& line) const {
    return WEXITSTATUS(
        std::system(("cd '" + folder.path().string() + "' && PATH=\"" +
                     fs::read_symlink("/proc/self/exe").parent_path().string() +
                     ":$PATH\" CA2_SOCKET=nowhere.sock && export CA2_SOCKET && " + line + " >output 2>errors")
                        .c_str()));
  }
};

TEST_F(Examples, AreUnderstood) {
  for (const auto& [command, line] : examples) {
    ASSERT_EQ(line.rfind("ca2 " + command, 0), 0u) << line;
    if (command == "configure" || command == "bench") continue;  // they ask the network, and take their time
    const int status = run(line.substr(0, line.find(" | ")));
    EXPECT_NE(status, 64) << line << "\n" << bytes_of(folder / "errors");
    EXPECT_NE(status, 78) << line << "\n" << bytes_of(folder / "errors");
    EXPECT_LT(status, 100) << line;
  }
}

TEST_F(Examples, OfASessionAndABoardDoWhatTheySay) {
  fs::rename(session, folder / "my-robot");
  int count = 0;
  for (const auto& [command, line] : examples) {
    const bool runs = (command == "solve" || command == "report" || command == "export" ||
                       command == "board" || command == "intrinsics") &&
                      line != "ca2 solve" && line.find("robot.urdf") == std::string::npos &&
                      line.find(" pictures ") == std::string::npos;
    if (!runs) continue;
    EXPECT_EQ(run(line), 0) << line << "\n" << bytes_of(folder / "errors");
    ++count;
  }
  EXPECT_GE(count, 8);
  EXPECT_EQ(run("ca2 check my-robot board.yaml plate.yaml odd.yaml"), 0) << bytes_of(folder / "errors");
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
