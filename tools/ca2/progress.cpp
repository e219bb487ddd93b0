#include "tools/ca2/progress.h"

#include <unistd.h>

#include <cstdio>
#include <utility>

namespace ca2 {

Progress::Progress(std::string label) : label_(std::move(label)), terminal_(isatty(STDERR_FILENO) != 0) {}

Progress::~Progress() {
  if (open_) std::fputc('\n', stderr);
}

void Progress::show(int done, int total) {
  if (!terminal_ || total <= 0) return;
  constexpr int cells = 30;
  const int filled = static_cast<int>(static_cast<long>(cells) * done / total);
  std::fprintf(stderr, "\r%s [%s%s] %d/%d", label_.c_str(),
               std::string(static_cast<std::size_t>(filled), '#').c_str(),
               std::string(static_cast<std::size_t>(cells - filled), '.').c_str(), done, total);
  open_ = done < total;
  if (!open_) std::fputc('\n', stderr);
  std::fflush(stderr);
}

}  // namespace ca2
