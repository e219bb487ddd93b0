/// @file A progress line on a terminal; nothing in a pipe.
#pragma once

#include <string>

namespace ca2 {

/// "\rlabel [#####.....] 12/40" on stderr while it is a terminal; ends with a newline when done.
class Progress {
 public:
  explicit Progress(std::string label);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  void show(int done, int total);

 private:
  std::string label_;
  bool terminal_;
  bool open_ = false;
};

}  // namespace ca2
