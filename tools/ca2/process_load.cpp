#include "tools/ca2/process_load.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

namespace ca2 {
namespace {

namespace fs = std::filesystem;

/// s, of a stat file: user and kernel time are the 14th and 15th field, the second is in brackets.
double cpu_of(const fs::path& stat) {
  std::string line;
  std::getline(std::ifstream(stat), line);
  const std::size_t name_end = line.rfind(')');
  if (name_end == std::string::npos) return 0;
  std::istringstream fields(line.substr(name_end + 1));
  std::string skipped;
  for (int i = 3; i < 14; ++i) fields >> skipped;
  double user = 0, kernel = 0;
  fields >> user >> kernel;
  return (user + kernel) / static_cast<double>(::sysconf(_SC_CLK_TCK));
}

}  // namespace

ProcessLoad process_load(pid_t process) {
  ProcessLoad load;
  const fs::path directory = "/proc/" + std::to_string(process);
  load.cpu = cpu_of(directory / "stat");
  std::error_code error;
  for (fs::directory_iterator task(directory / "task", error), end; !error && task != end;
       task.increment(error)) {
    std::string name;
    std::getline(std::ifstream(task->path() / "comm"), name);
    load.cpu_by_thread[name] += cpu_of(task->path() / "stat");
  }
  std::ifstream status(directory / "status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmRSS:")) load.resident = 1024 * std::stod(line.substr(6));
    if (line.starts_with("VmHWM:")) load.most_resident = 1024 * std::stod(line.substr(6));
  }
  return load;
}

}  // namespace ca2
