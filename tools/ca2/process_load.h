/// @file What a running process costs, from /proc.
#pragma once

#include <sys/types.h>

#include <map>
#include <string>

namespace ca2 {

struct ProcessLoad {
  std::map<std::string, double> cpu_by_thread;  ///< s, user and kernel, by the thread's name
  double cpu = 0;                               ///< s, of all threads, ended ones too
  double resident = 0, most_resident = 0;       ///< bytes
};

/// Zeros where there is no such process.
ProcessLoad process_load(pid_t process);

}  // namespace ca2
