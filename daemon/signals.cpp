#include "daemon/signals.h"

#include <pthread.h>
#include <sys/signalfd.h>

namespace ca2 {
namespace {

sigset_t heard() {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : {SIGTERM, SIGINT, SIGHUP}) sigaddset(&set, signal);
  return set;
}

}  // namespace

void block_signals() {
  const sigset_t set = heard();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
}

UniqueFd signal_descriptor() {
  const sigset_t set = heard();
  return UniqueFd(::signalfd(-1, &set, SFD_CLOEXEC | SFD_NONBLOCK));
}

int next_signal(const UniqueFd& descriptor) {
  signalfd_siginfo info{};
  const ssize_t size = ::read(descriptor.get(), &info, sizeof(info));
  return size == sizeof(info) ? static_cast<int>(info.ssi_signo) : 0;
}

}  // namespace ca2
