#include "tools/ca2/terminal.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

namespace ca2 {
namespace {

void put(const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t size = ::write(STDOUT_FILENO, text.data() + done, text.size() - done);
    if (size < 0 && errno != EINTR) return;
    if (size > 0) done += static_cast<std::size_t>(size);
  }
}

}  // namespace

bool Terminal::available() {
  return ::isatty(STDIN_FILENO) != 0 && ::isatty(STDOUT_FILENO) != 0;
}

Terminal::Size Terminal::size() {
  winsize window{};
  if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &window) != 0 || window.ws_col == 0) return {};
  return {window.ws_col, window.ws_row};
}

Terminal::Terminal() {
  ::tcgetattr(STDIN_FILENO, &before_);
  termios raw = before_;
  raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  raw.c_cc[VMIN] = 0;
  raw.c_cc[VTIME] = 0;
  ::tcsetattr(STDIN_FILENO, TCSANOW, &raw);
  put("\033[?1049h\033[?25l\033[2J");
}

Terminal::~Terminal() {
  put("\033[0m\033[?25h\033[?1049l");
  ::tcsetattr(STDIN_FILENO, TCSANOW, &before_);
}

void Terminal::show(const std::vector<std::string>& lines) {
  std::string out;
  const Size now = size();
  if (now.columns != size_.columns || now.rows != size_.rows) {
    size_ = now;
    shown_.clear();
    out += "\033[0m\033[2J";
  }
  for (std::size_t row = 0; row < std::max(lines.size(), shown_.size()); ++row) {
    const std::string line = row < lines.size() ? lines[row] : "";
    if (row < shown_.size() && shown_[row] == line) continue;
    out += "\033[" + std::to_string(row + 1) + ";1H" + line + "\033[0m\033[K";
  }
  shown_ = lines;
  put(out);
}

void Terminal::bell() {
  put("\a");
}

char Terminal::key() {
  char key = 0;
  return ::read(STDIN_FILENO, &key, 1) == 1 ? key : '\0';
}

}  // namespace ca2
