/// @file Numbers on the command line are judged where it is read, every one of them.
#include <gtest/gtest.h>

#include <regex>
#include <sstream>

#include "tests/tools/ca2/program.h"

namespace ca2 {
namespace {

using test::run_ca2;
using Words = std::vector<std::string>;

TEST(NumberOptions, WhatIsNoNumberInTheRangeIsRefusedInOneWay) {
  const std::vector<std::pair<Words, const char*>> cases{
      {{"status", "--lcm", "udpm://239.255.76.67:7667?ttl=0", "--timeout", "-1"}, "--timeout: '-1'"},
      {{"status", "--timeout", "nan"}, "--timeout: 'nan'"},
      {{"sensors", "--duration", "0"}, "--duration: '0'"},
      {{"sensors", "--duration", "inf"}, "--duration: 'inf'"},
      {{"sensors", "--port", "0"}, "--port: '0'"},
      {{"record", "packets", "--output", "x", "--duration", "1e30"}, "--duration: '1e30'"},
      {{"play", "x.pcap", "--to", "localhost", "--speed", "nan"}, "--speed: 'nan'"},
      {{"replay", "x", "--session", "y", "--dwell", "nan"}, "--dwell: 'nan'"},
      {{"import", "x", "--output", "y", "--tolerance", "nan"}, "--tolerance: 'nan'"},
      {{"board", "--output", "x.svg", "--square", "nan"}, "--square: 'nan'"},
      {{"board", "--output", "x.svg", "--columns", "-3"}, "--columns: '-3'"},
      {{"pick", "top", "3", "-1"}, "column: '-1'"},
      {{"drop", "-1"}, "view: '-1'"},
      {{"snap", "pattern:", "x.png", "--timeout", "1e300"}, "--timeout: '1e300'"},
      {{"configure", "x", "--wait", "-5"}, "--wait: '-5'"},
      {{"solve", "x", "--threads", "0"}, "--threads: '0'"},
  };
  for (const auto& [words, expected] : cases) {
    const test::Outcome outcome = run_ca2(words);
    EXPECT_EQ(outcome.status, 64) << words.front() << "\n" << outcome.errors;
    EXPECT_NE(outcome.errors.find(std::string(expected) + " is not a number from "), std::string::npos)
        << outcome.errors;
  }
}

/// The help of every command and its own: no number without the range that it must be in.
TEST(NumberOptions, EveryOneHasARange) {
  const auto commands_of = [](const Words& words) {
    Words help = words;
    help.push_back("--help");
    const std::string text = run_ca2(help).output;
    std::istringstream lines(text);
    Words commands;
    bool listed = false;
    for (std::string line; std::getline(lines, line);) {
      EXPECT_FALSE(std::regex_search(line, std::regex("^  \\S+(,\\S+)?.* U?(INT|FLOAT)( |$)"))) << line;
      if (line.starts_with("Subcommands:")) {
        listed = true;
      } else if (line.empty()) {
        listed = false;
      } else if (std::smatch name; listed && std::regex_search(line, name, std::regex("^  ([a-z_]+) "))) {
        commands.push_back(name[1]);
      }
    }
    return commands;
  };
  const Words commands = commands_of({});
  EXPECT_GT(commands.size(), 20u);
  for (const std::string& command : commands) {
    for (const std::string& below : commands_of({command})) commands_of({command, below});
  }
}

}  // namespace
}  // namespace ca2
