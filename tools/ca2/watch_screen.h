/// @file What `ca2 watch` shows, as lines of text: no terminal in here.
#pragma once

#include <string>
#include <vector>

#include "messages/status.h"

namespace ca2 {

struct WatchView {
  DaemonStatus status;
  std::string note;                  ///< what became of the last key; empty: nothing
  std::string picture_of;            ///< sensor
  std::vector<std::string> picture;  ///< lines of it, as terminals show them
};

/// At most `height` lines of at most `width` columns (from 40), with colours; the picture is what there is
/// room for at the end. picture_rows() of the same width and height says how much that is.
std::vector<std::string> watch_lines(const WatchView& view, int width, int height);
int picture_rows(const WatchView& view, int width, int height);

/// Words broken at spaces into lines of at most `width` characters.
std::vector<std::string> wrapped(const std::string& text, int width);

}  // namespace ca2
