/// @file A small simulated session, made once by `ca2 simulate`, to be copied, damaged and solved.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/support/temporary_directory.h"
#include "tests/tools/ca2/program.h"

namespace ca2::test {

/// The whole content; empty where there is no such file.
std::string bytes_of(const std::filesystem::path& file);
void write_bytes(const std::filesystem::path& file, const std::string& content);

/// Every test has its own copy of the same eight views of a checkerboard by a 640 x 480 camera "front" and a
/// VLP-16 "puck", already solved once: the cache is filled, there is no result.
class SmallSession : public testing::Test {
 protected:
  static constexpr int view_count = 8;

  void SetUp() override;

  std::filesystem::path picture(int view) const { return view_file(view, "front.png"); }
  std::filesystem::path cloud(int view) const { return view_file(view, "puck.pcd"); }
  std::filesystem::path view_file(int view, const std::string& name) const;
  std::filesystem::path result() const { return session / "result.yaml"; }
  /// Replaces the first `from` in session.yaml, which must be there.
  void edit_rig(const std::string& from, const std::string& to) const;
  /// `ca2 solve SESSION` with further arguments.
  Outcome solve(const std::vector<std::string>& options = {}) const;

  TemporaryDirectory folder;
  std::filesystem::path session = folder / "session";
};

}  // namespace ca2::test
