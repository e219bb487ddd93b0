#include "tests/tools/ca2/program.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <iterator>
#include <stdexcept>

namespace ca2::test {
namespace {

std::string content(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace

Program::Program(const std::vector<std::string>& arguments) {
  char name[] = "/tmp/ca2_run_XXXXXX";
  directory_ = mkdtemp(name);
  std::vector<std::string> words{std::filesystem::read_symlink("/proc/self/exe").replace_filename("ca2")};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  const int mode = O_WRONLY | O_CREAT | O_TRUNC;
  posix_spawn_file_actions_addopen(&actions, 1, (directory_ / "output").c_str(), mode, 0600);
  posix_spawn_file_actions_addopen(&actions, 2, (directory_ / "errors").c_str(), mode, 0600);
  const int code = posix_spawn(&process_, pointers[0], &actions, nullptr, pointers.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (code != 0) throw std::runtime_error("cannot run " + words[0]);
}

Program::~Program() {
  if (process_ > 0) {
    ::kill(process_, SIGKILL);
    wait();
  }
  std::filesystem::remove_all(directory_);
}

int Program::wait() {
  int status = 0;
  ::waitpid(process_, &status, 0);
  process_ = -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

std::string Program::output() const {
  return content(directory_ / "output");
}

std::string Program::errors() const {
  return content(directory_ / "errors");
}

Outcome run_ca2(const std::vector<std::string>& arguments) {
  Program program(arguments);
  Outcome run;
  run.status = program.wait();
  run.output = program.output();
  run.errors = program.errors();
  return run;
}

}  // namespace ca2::test
