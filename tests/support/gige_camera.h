/// @file Runs the fake GigE camera (tests/devices/fake_gige_camera.cpp) that was built beside the test.
#pragma once

#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/temporary_directory.h"

namespace ca2::test {

/// A camera on the network, as long as it lives. It shows the same bytes in every picture.
class GigeCamera {
 public:
  GigeCamera(std::string address, std::string serial, std::string picture = "", double lost = 0)
      : address_(std::move(address)), serial_(std::move(serial)), picture_(std::move(picture)), lost_(lost) {
    start();
  }
  GigeCamera(const GigeCamera&) = delete;
  GigeCamera& operator=(const GigeCamera&) = delete;
  ~GigeCamera() { kill(); }

  /// As a power cut: nothing is said to anybody.
  void kill() {
    if (process_ <= 0) return;
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
    process_ = -1;
  }
  void freeze() { ::kill(process_, SIGSTOP); }

  void start() {
    std::vector<std::string> words{
        std::filesystem::read_symlink("/proc/self/exe").replace_filename("fake_gige_camera"), address_,
        serial_, std::to_string(lost_)};
    if (!picture_.empty()) {
      std::ofstream(directory_ / "picture", std::ios::binary) << picture_;
      words.push_back(directory_ / "picture");
    }
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    int ends[2];
    if (::pipe(ends) != 0) throw std::runtime_error("no pipe");
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], 1);
    posix_spawn_file_actions_addclose(&actions, ends[0]);
    const int code = ::posix_spawn(&process_, pointers[0], &actions, nullptr, pointers.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    ::close(ends[1]);
    char answer[8] = {};
    const auto got = code == 0 ? ::read(ends[0], answer, sizeof answer - 1) : 0;
    ::close(ends[0]);
    if (got <= 0) throw std::runtime_error("the fake camera does not start: was fake_gige_camera built?");
  }

 private:
  const std::string address_, serial_, picture_;
  const double lost_;
  const TemporaryDirectory directory_;
  pid_t process_ = -1;
};

}  // namespace ca2::test
