/// @file Runs the `ca2` that was built beside the test.
#pragma once

#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

namespace ca2::test {

/// A running `ca2`; its outputs go to files.
class Program {
 public:
  explicit Program(const std::vector<std::string>& arguments);
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  ~Program();

  void interrupt() { ::kill(process_, SIGINT); }
  /// Waits for the end; the exit status, or -1 when it was killed.
  int wait();

  std::string output() const;
  std::string errors() const;

 private:
  std::filesystem::path directory_;
  pid_t process_ = -1;
};

/// Runs it to its end.
struct Outcome {
  int status = -1;
  std::string output, errors;
};
Outcome run_ca2(const std::vector<std::string>& arguments);

}  // namespace ca2::test
