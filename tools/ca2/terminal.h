/// @file A terminal taken over for a full screen, and given back.
#pragma once

#include <termios.h>

#include <string>
#include <vector>

namespace ca2 {

/// While it lives: no echo, keys at once, the other screen, no cursor.
class Terminal {
 public:
  Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;
  ~Terminal();

  /// Are standard input and output both terminals?
  static bool available();

  struct Size {
    int columns = 80, rows = 24;
  };
  static Size size();

  /// Writes only the lines that changed: links may be slow.
  void show(const std::vector<std::string>& lines);
  void bell();
  /// 0 when no key was pressed.
  static char key();

 private:
  termios before_{};
  std::vector<std::string> shown_;
  Size size_;
};

}  // namespace ca2
